#include "scenes/lexer.h"

#include <gtest/gtest.h>
