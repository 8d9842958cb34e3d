#include "apps/cli/run_program.hpp"

#include <process.h>

#include <filesystem>

namespace palpate {

namespace {

// The started program splits its command line again, at spaces outside quotation marks.
std::wstring quoted(const std::string& word) {
  std::wstring text = L"\"";
  std::size_t backslashes = 0;
  for (const wchar_t c : std::filesystem::path(word).wstring()) {
    if (c == L'"') text.append(backslashes + 1, L'\\');
    backslashes = c == L'\\' ? backslashes + 1 : 0;
    text += c;
  }
  return text.append(backslashes, L'\\') + L'"';
}

}  // namespace

int runProgram(const std::string& program, std::vector<std::string> arguments) {
  arguments.insert(arguments.begin(), program);
  std::vector<std::wstring> words;
  for (const std::string& argument : arguments) words.push_back(quoted(argument));
  std::vector<const wchar_t*> pointers;
  for (const std::wstring& word : words) pointers.push_back(word.c_str());
  pointers.push_back(nullptr);
  const std::intptr_t code = ::_wspawnvp(_P_WAIT, std::filesystem::path(program).c_str(), pointers.data());
  return code < 0 ? 127 : static_cast<int>(code);
}

std::vector<std::string> pythonNames() { return {"python", "py"}; }

}  // namespace palpate
