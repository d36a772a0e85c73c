#include "solve/vumat_utilities.hpp"

#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <cstdio>
#include <cstring>
#include <string>
#include <string_view>

#include "solve/law_guard.hpp"

namespace interply::solve {

const char* list_vumat_utilities() {
  return "xplb_abqerr, xplb_exit, vgetoutdir, vgetnumcpus, vgetrank, get_thread_id, getnumthreads";
}

namespace {

std::string_view trim(std::string_view s) { return s.substr(0, s.find_last_not_of(' ') + 1); }

/// Arrays that were left out in the call are null: their places stay as they are.
std::string fill_in(std::string_view text, const int* intv, const double* realv, const char* charv) {
  constexpr std::size_t kWord = 8;  // of an element of charv
  std::string line;
  for (std::size_t i = 0; i < text.size(); ++i) {
    const char kind = text[i] == '%' && i + 1 < text.size() ? text[i + 1] : ' ';
    if (kind == 'I' && intv) {
      line += std::to_string(*intv++);
    } else if (kind == 'R' && realv) {
      line += fmt::format("{:.6g}", *realv++);
    } else if (kind == 'S' && charv) {
      line += trim({charv, kWord});
      charv += kWord;
    } else {
      line += text[i];
      continue;
    }
    ++i;
  }
  return line;
}

}  // namespace
}  // namespace interply::solve

// As gfortran calls them: names in small letters with an underscore, lengths of characters last and by value.
extern "C" {

void xplb_abqerr_(const int* lop, const char* text, const int* intv, const double* realv, const char* charv,
                  std::size_t length) {
  using namespace interply::solve;
  const char* kind = *lop > 0 ? "note" : *lop == -1 ? "warning" : "error";
  const std::string line = fmt::format("{} of the law: {}\n", kind, fill_in(trim({text, length}), intv, realv, charv));
  std::fputs(line.c_str(), stderr);
  if (*lop == -3) end_by_law("it called xplb_abqerr with -3");
}

void xplb_exit_() { interply::solve::end_by_law("it called xplb_exit"); }

void vgetoutdir_(char* folder, int* folder_length, std::size_t capacity) {
  char name[4096] = "";
  if (!getcwd(name, sizeof name)) name[0] = '\0';
  const std::size_t length = std::min(std::strlen(name), capacity);
  std::memset(folder, ' ', capacity);
  std::memcpy(folder, name, length);
  *folder_length = static_cast<int>(length);
}

void vgetnumcpus_(int* n) { *n = 1; }
void vgetrank_(int* rank) { *rank = 0; }
int get_thread_id_() { return 0; }
int getnumthreads_() { return 1; }
}
