#include "io/spelling.h"

#include <algorithm>
#include <numeric>
#include <vector>

namespace pellucid::io {

// Edits (insert, delete, replace) between two words [Levenshtein 1966].
static size_t distance(std::string_view a, std::string_view b) {
    std::vector<size_t> row(b.size() + 1);
    std::iota(row.begin(), row.end(), size_t{0});
    for (size_t i = 0; i < a.size(); ++i) {
        size_t diagonal = row[0];
        row[0] = i + 1;
        for (size_t j = 0; j < b.size(); ++j) {
            const size_t replaced = diagonal + (a[i] != b[j]);
            diagonal = row[j + 1];
            row[j + 1] = std::min({row[j] + 1, row[j + 1] + 1, replaced});
        }
    }
    return row.back();
}

std::string nearestWord(std::string_view given, std::span<const std::string> known) {
    size_t least = 2 + given.size() / 3;
    std::string nearest;
    for (const std::string& word : known)
        if (const size_t d = distance(word, given); d < least) least = d, nearest = word;
    return nearest;
}

}  // namespace pellucid::io
