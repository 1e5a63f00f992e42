/* replay.cpp - gives the files of a folder to the fuzz target, without libFuzzer.
   usage: replay FILE... */
#include <cstdint>
#include <cstdio>
#include <fstream>
#include <iterator>
#include <vector>

extern "C" int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);

int main(int argc, char **argv) {
    for (int i = 1; i < argc; i++) {
        std::ifstream file(argv[i], std::ios::binary);
        const std::vector<char> text((std::istreambuf_iterator<char>(file)),
                                     std::istreambuf_iterator<char>());
        if (!file) {
            std::fprintf(stderr, "replay: %s cannot be read\n", argv[i]);
            return 1;
        }
        std::fprintf(stderr, "%s\n", argv[i]); /* the last one is to blame for a crash */
        LLVMFuzzerTestOneInput((const uint8_t *)text.data(), text.size());
    }
    std::printf("%d inputs\n", argc - 1);
    return argc > 1 ? 0 : 1;
}
