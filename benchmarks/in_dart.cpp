// An exported VSK in DART, posed by the numbers of the V file: where it puts the segments.
//
//     python -m benchmarks.formats --keep FOLDER
//     apt-get install libdart-utils-dev libdart-external-ikfast-dev
//     g++ -std=c++17 benchmarks/in_dart.cpp -I/usr/include/eigen3 -ldart-utils -ldart -lassimp -lfcl -lccd -o in_dart
//     ./in_dart FOLDER

#include <cmath>
#include <cstdio>
#include <dart/dart.hpp>
#include <dart/utils/VskParser.hpp>
#include <fstream>
#include <string>

int main(int, char** argv) {
  const std::string folder = argv[1];
  auto hand = dart::utils::VskParser::readSkeleton(
      dart::common::Uri::createFromPath(folder + "/hand.vsk"));
  if (!hand) return 1;
  std::printf("bodies %zu, degrees of freedom %zu, markers %zu\n", hand->getNumBodyNodes(),
              hand->getNumDofs(), hand->getNumMarkers());
  std::ifstream numbers(folder + "/for_dart.txt"), truth(folder + "/dart_wants.txt");
  Eigen::VectorXd q(hand->getNumDofs());
  double worst = 0, value;
  int moments = 0;
  while (numbers >> value) {
    q[0] = value;
    for (int i = 1; i < q.size(); ++i) numbers >> q[i];
    hand->setPositions(q);
    for (std::size_t i = 0; i < hand->getNumBodyNodes(); ++i) {
      const auto at = hand->getBodyNode(i)->getWorldTransform().translation();
      for (int k = 0; k < 3; ++k) {
        truth >> value;
        worst = std::max(worst, std::abs(at[k] - value));
      }
    }
    ++moments;
  }
  std::printf("%d moments, greatest distance %.1e m\n", moments, worst);
  return moments ? 0 : 1;
}
