//! Writes the pictures of `docs/command.md`: what the command shows on a terminal, as SVG, in the folder that is named.
//! `cargo xtask screenshots terminal` runs it.

use std::{env, error::Error, fs, path::Path, process::Command, thread::sleep, time::Duration};

use anstyle_svg::Term;
use terminal::Terminal;
use vt100::{Cell, Color};

#[expect(
    dead_code,
    clippy::unwrap_used,
    clippy::indexing_slicing,
    reason = "it is of the tests, which use more of it"
)]
#[path = "../tests/terminal/mod.rs"]
mod terminal;

/// Lines of commands that end by themselves.
const LINES: [(&str, &str); 2] = [
    ("doctor", "--virtual doctor --rpm 60 --yes"),
    ("step", "--virtual step to_rpm=120 --yes"),
];
/// How long motors turn before the picture of `control` is taken: the graph is full then.
const TURNS: Duration = Duration::from_secs(8);

fn main() -> Result<(), Box<dyn Error>> {
    let folder = env::args().nth(1).ok_or("name the folder")?;
    let folder = Path::new(&folder);
    fs::create_dir_all(folder)?;
    for (name, line) in LINES {
        let (_, shown) = Terminal::run(command(line)).end();
        write(folder, name, line, &shown)?;
    }
    let line = "--virtual=2 --id 1,-2 control --latch";
    let mut control = Terminal::run(command(line));
    control.expect("MotorLink");
    control.press("g");
    sleep(Duration::from_millis(300));
    control.press("f");
    sleep(TURNS);
    let shown = control.shown();
    control.press("q");
    control.end();
    write(folder, "control", line, &shown)
}

fn command(line: &str) -> Command {
    let program = env::var_os("MOTORLINK_COMMAND").unwrap_or_else(|| "motorlink".into());
    let mut command = Command::new(program);
    command.args(line.split(' ')).env("TERM", "xterm-256color");
    command
}

/// Writes a picture of the screen, with the prompt above it.
fn write(folder: &Path, name: &str, line: &str, shown: &str) -> Result<(), Box<dyn Error>> {
    const ROWS: u16 = 40;
    const COLUMNS: u16 = 100;
    let mut screen = vt100::Parser::new(ROWS, COLUMNS, 0);
    screen.process(shown.as_bytes());
    let screen = screen.screen();
    let rows = (0..ROWS).map(|row| {
        let cells = (0..COLUMNS).filter_map(|column| screen.cell(row, column));
        cells.fold(String::new(), |text, cell| text + &coloured(cell))
    });
    let mut text = format!("$ motorlink {line}\n");
    text.extend(rows.map(|row| row + "\n"));
    let picture = Term::new().render_svg(text.trim_end_matches(['\n', ' ']));
    Ok(fs::write(folder.join(format!("{name}.svg")), picture)?)
}

/// A cell with the codes of its colour and weight.
fn coloured(cell: &Cell) -> String {
    let text = match cell.contents() {
        "" => " ",
        text => text,
    };
    let bold = if cell.bold() { "\x1b[1m" } else { "" };
    match cell.fgcolor() {
        Color::Idx(colour @ 0..8) => format!("{bold}\x1b[3{colour}m{text}\x1b[0m"),
        _ if cell.bold() => format!("{bold}{text}\x1b[0m"),
        _ => text.to_owned(),
    }
}
