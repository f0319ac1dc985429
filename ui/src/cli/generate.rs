//! `afterimage completions`, `man` and `licences`: files that are installed with the program.

use super::{failure::Failure, output};
use clap::{Args, Command};
use clap_complete::Shell;

#[derive(Args, Debug)]
pub(crate) struct CompletionsArgs {
    /// bash, elvish, fish, powershell or zsh.
    shell: Shell,
}

/// Prints the completion script, generated from the definition of the flags.
pub(crate) fn completions(args: &CompletionsArgs, mut command: Command) -> Result<(), Failure> {
    let mut text = Vec::new();
    clap_complete::generate(args.shell, &mut command, "afterimage", &mut text);
    output::data(String::from_utf8_lossy(&text).trim_end());
    Ok(())
}

/// Prints one manual page, with a section for each command.
pub(crate) fn man(command: Command) -> Result<(), Failure> {
    let failed =
        |error: std::io::Error| Failure::Failed(format!("the manual page cannot be generated: {error}"));
    let mut text = Vec::new();
    clap_mangen::Man::new(command.clone()).render(&mut text).map_err(failed)?;
    for sub in command.get_subcommands() {
        let name = sub.get_name().to_uppercase();
        text.extend(format!(".SH COMMAND {name}\n").bytes());
        let page = clap_mangen::Man::new(sub.clone());
        page.render_description_section(&mut text).map_err(failed)?;
        page.render_options_section(&mut text).map_err(failed)?;
    }
    output::data(String::from_utf8_lossy(&text).trim_end());
    Ok(())
}

/// Prints the list of licences, which the tests keep up to date.
pub(crate) fn licences() -> Result<(), Failure> {
    output::data(include_str!("../../../assets/LICENCES.md").trim_end());
    Ok(())
}
