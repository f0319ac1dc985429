//! The command lines of the documentation.

/// Returns the arguments of each command of the program in the blocks of shell commands of a page.
/// Lines with `[` are synopses, and are left out.
pub(crate) fn commands(page: &str) -> Vec<Vec<String>> {
    let mut blocks = page.split("```sh\n").skip(1).filter_map(|rest| rest.split("```").next());
    let joined = blocks.by_ref().map(|block| block.replace("\\\n", " ")).collect::<Vec<_>>().join("\n");
    joined.lines().filter(|line| !line.contains(" [")).filter_map(arguments).collect()
}

/// Returns the arguments of the program in a line; `None` where it is another program's, or itself an
/// argument of a script.
fn arguments(line: &str) -> Option<Vec<String>> {
    let line = line.split(" #").next().filter(|line| !line.contains(".py "))?;
    let mut words = line.split_whitespace().map(|word| word.trim_matches('"'));
    let is_program = |word: &&str| *word == "afterimage" || word.ends_with("/afterimage");
    let program = words.find(|word| is_program(word) || *word == "cargo")?;
    if program == "cargo" && !(line.contains("cargo run") && words.any(|word| word == "--")) {
        return None;
    }
    Some(words.take_while(|word| !["&&", "|", ">", ";"].contains(word)).map(str::to_owned).collect())
}
