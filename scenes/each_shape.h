#pragma once
#include "scenes/description.h"

namespace penumbra {

/// Calls visit(shape) for every shape of the world and of every object.
template <class Visit>
void each_shape(const SceneDescription& description, Visit&& visit) {
  for (const ShapeEntity& shape : description.shapes) visit(shape);
  for (const ObjectEntity& object : description.objects)
    for (const ShapeEntity& shape : object.shapes) visit(shape);
}

}  // namespace penumbra
