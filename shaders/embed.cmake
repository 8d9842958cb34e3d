# Writes the words of ${SPIRV} into ${SOURCE} as the ShaderCode ${SYMBOL} of the table ${TABLE}.
file(READ ${SPIRV} hex HEX)
string(REGEX REPLACE "(..)(..)(..)(..)" "0x\\4\\3\\2\\1," words "${hex}")
string(REPEAT "0x[0-9a-f]+," 8 line)
string(REGEX REPLACE "(${line})" "\\1\n" words "${words}")
file(WRITE ${SOURCE} "#include \"shaders/${TABLE}.hpp\"
namespace palpate::shader_code {
static constexpr std::uint32_t ${SYMBOL}_words[] = {
${words}};
const ShaderCode ${SYMBOL}{\"${SYMBOL}\", ${SYMBOL}_words, ${TABLE}};
}
")
