#include "base/error.h"

#include <gtest/gtest.h>

using namespace faceta;

TEST(Error, TextNamesPlaceMessageAndHint) {
  Error e("bsdf has no parameter 'eta'", {"a.xml", 17, 10}, "did you mean 'int_ior'?");
  EXPECT_STREQ(e.what(),
               "a.xml:17:10: error: bsdf has no parameter 'eta' (did you mean 'int_ior'?)");
}

TEST(Error, SuggestionFindsTheNearestName) {
  EXPECT_EQ(suggestion("alhpa", {"alpha", "eta"}), "did you mean 'alpha'? known: alpha, eta");
  EXPECT_EQ(suggestion("zzzzzz", {"alpha"}), "known: alpha");
  EXPECT_EQ(suggestion("x", {}), "");
}
