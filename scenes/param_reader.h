#pragma once
// The parameter list of a directive: `"type name" value`, `"type name" [ values ]`, any number of times.
#include "absl/status/statusor.h"
#include "scenes/diagnostics.h"
#include "scenes/token_stream.h"

namespace penumbra {

/// Reads parameters as long as the next token is a string. Every number is finite and fits a float (an
/// integer: 32 bits); types are normalised as description.h says. Texture names are not looked up.
absl::StatusOr<Params> read_params(TokenStream& tokens, Diagnostics& diagnostics);

/// One finite number that fits a float.
absl::StatusOr<double> read_number(TokenStream& tokens, Diagnostics& diagnostics);

/// The value of a number token; the error says what is wrong with it.
absl::StatusOr<double> number_of(const Token& token, const Diagnostics& diagnostics);

}  // namespace penumbra
