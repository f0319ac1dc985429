//! `afterimage completions`, `man`, `licences` and `schema`: texts that belong to the program.

use super::{failure::Failure, output};
use clap::{Args, Command, ValueEnum};
use clap_complete::Shell;

#[derive(Args, Debug)]
pub(crate) struct CompletionsArgs {
    /// bash, elvish, fish, powershell or zsh.
    shell: Shell,
}

#[derive(Args, Debug)]
pub(crate) struct SchemaArgs {
    /// Which file is described: settings.toml, or the NAME.afterimage.toml next to a model.
    #[arg(value_enum)]
    file: SchemaOf,
}

/// The files that have a schema.
#[derive(Clone, Copy, Debug, ValueEnum)]
enum SchemaOf {
    Settings,
    Sidecar,
}

/// Prints a JSON Schema, by which editors complete and check a TOML file.
pub(crate) fn schema(args: &SchemaArgs) -> Result<(), Failure> {
    let text = match args.file {
        SchemaOf::Settings => include_str!("../../assets/settings.schema.json"),
        SchemaOf::Sidecar => include_str!("../../assets/sidecar.schema.json"),
    };
    output::data(text.trim_end());
    Ok(())
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

/// Prints the list of licences and their texts, which the tests keep up to date.
pub(crate) fn licences() -> Result<(), Failure> {
    output::data(include_str!("../../assets/LICENCES.md"));
    output::data(include_str!("../../assets/LICENCE-TEXTS.txt").trim_end());
    Ok(())
}
