//! `motorlink completions` and `motorlink man`: made of the command line itself.

use std::{
    io::{Write, stdout},
    path::Path,
};

use clap::CommandFactory;
use clap_complete::{Shell, generate};

use crate::{arguments::Arguments, failure::Failure};

/// Prints the completions.
pub fn completions(shell: Shell) -> Result<(), Failure> {
    let mut text = Vec::new();
    generate(shell, &mut Arguments::command(), "motorlink", &mut text);
    stdout().write_all(&text).map_err(Failure::output)
}

/// Writes a page for each command.
pub fn pages(folder: &Path) -> Result<(), Failure> {
    std::fs::create_dir_all(folder).map_err(Failure::file(folder))?;
    clap_mangen::generate_to(Arguments::command(), folder).map_err(Failure::file(folder))
}
