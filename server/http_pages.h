#pragma once
// What the HTTP side shows: /metrics, /healthz, the dashboard and its data. Translates only.
#include <string>

#include "server/http_preview.h"
#include "server/http_server.h"
#include "server/http_snapshot.h"

namespace penumbra {

class HttpPages {
 public:
  explicit HttpPages(Coordinator& coordinator)
      : coordinator_(coordinator), snapshots_(coordinator), previews_(coordinator) {}

  /// Thread-safe. Paths: / and its files, /healthz, /metrics, /api/state, /api/jobs/ID,
  /// /api/jobs/ID/image.png?mix=N. 404 for any other, 503 while the coordinator cannot answer.
  HttpReply answer(const HttpRequest& request);

 private:
  HttpReply state();
  HttpReply job(const JobId& id);
  HttpReply image(const JobId& id, const std::string& mix);

  Coordinator& coordinator_;
  Snapshots snapshots_;
  Previews previews_;
};

}  // namespace penumbra
