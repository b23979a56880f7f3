#include "tests/experiments/methods/method.h"

#include <algorithm>
#include <cassert>
#include <iterator>
#include <utility>

namespace maploc::experiments {

const std::vector<Method>& AllMethods() {
  static const std::vector<Method> all = [] {
    std::vector<Method> methods;
    for (std::vector<Method> family :
         {OurMethods(), BaselineMethods(), OpenCvMethods(), OpenGvMethods()}) {
      std::move(family.begin(), family.end(), std::back_inserter(methods));
    }
    return methods;
  }();
  return all;
}

std::vector<std::string> AllMethodNames() {
  std::vector<std::string> names;
  for (const Method& method : AllMethods()) names.push_back(method.name);
  return names;
}

const Method& MethodByName(std::string_view name) {
  const std::vector<Method>& all = AllMethods();
  const auto found = std::ranges::find(all, name, &Method::name);
  assert(found != all.end());
  return *found;
}

}  // namespace maploc::experiments
