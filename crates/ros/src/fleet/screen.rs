//! All robots on the full screen.

use std::{
    env,
    io::IsTerminal as _,
    sync::{
        Arc,
        atomic::{AtomicBool, Ordering},
    },
    time::{Duration, Instant},
};

use anyhow::{Context as _, Result};
use ratatui::{
    DefaultTerminal, Frame,
    crossterm::event::{self, Event, KeyCode, KeyEvent, KeyEventKind, KeyModifiers},
    layout::{Constraint, Layout},
    style::{Color, Modifier, Style},
    text::Line,
    widgets::{Row, Table},
};
use signal_hook::consts::{SIGHUP, SIGINT, SIGTERM};

use super::{
    listening::{Listening, View},
    table::{COLUMNS, cells, head},
};
use crate::status::Level;

/// How often it is drawn without a key.
const PERIOD: Duration = Duration::from_millis(500);
/// A page of robots, where the height of the terminal is not known.
const PAGE: usize = 10;

/// Whether there is a terminal to draw on.
pub fn is_there() -> bool {
    std::io::stdout().is_terminal() && std::io::stdin().is_terminal()
}

/// Shows all robots until a key or a signal ends it, and restores the terminal whatever comes.
pub fn show(listening: &Listening) -> Result<()> {
    let ends = Arc::new(AtomicBool::new(false));
    for signal in [SIGINT, SIGTERM, SIGHUP] {
        signal_hook::flag::register(signal, Arc::clone(&ends))?;
    }
    // It also restores the terminal before a panic is printed.
    let terminal = ratatui::try_init().context("there is no terminal: use --once or --json")?;
    let done = run(terminal, listening, &ends);
    ratatui::restore();
    done
}

fn run(mut terminal: DefaultTerminal, listening: &Listening, ends: &AtomicBool) -> Result<()> {
    // https://no-color.org
    let has_colours = env::var_os("NO_COLOR").is_none_or(|value| value.is_empty());
    let mut first = 0;
    while !ends.load(Ordering::Relaxed) {
        let view = listening.view();
        first = first.min(view.rows.len().saturating_sub(1));
        terminal.draw(|frame| draw(frame, &view, first, has_colours))?;
        let page = terminal
            .size()
            .map_or(PAGE, |size| usize::from(size.height));
        let page = page.saturating_sub(3).max(1);
        let until = Instant::now() + PERIOD;
        while event::poll(until.saturating_duration_since(Instant::now()))? {
            match event::read()? {
                Event::Key(key) if key.kind == KeyEventKind::Release => {}
                Event::Key(key) if is_end(key) => return Ok(()),
                Event::Key(key) => {
                    first = match key.code {
                        KeyCode::Up => first.saturating_sub(1),
                        KeyCode::Down => first + 1,
                        KeyCode::PageUp => first.saturating_sub(page),
                        KeyCode::PageDown => first + page,
                        KeyCode::Home => 0,
                        KeyCode::End => view.rows.len().saturating_sub(page),
                        _ => continue,
                    };
                    break;
                }
                _ => break,
            }
        }
    }
    Ok(())
}

fn is_end(key: KeyEvent) -> bool {
    let is_control = key.modifiers.contains(KeyModifiers::CONTROL);
    matches!(key.code, KeyCode::Esc | KeyCode::Char('q'))
        || is_control && key.code == KeyCode::Char('c')
}

fn draw(frame: &mut Frame<'_>, view: &View, first: usize, has_colours: bool) {
    let areas = Layout::vertical([
        Constraint::Length(1),
        Constraint::Min(2),
        Constraint::Length(1),
    ]);
    let [top, middle, bottom] = areas.areas(frame.area());
    let text = head(&view.rows, view.ignored, view.has_router);
    frame.render_widget(Line::raw(text).style(Modifier::BOLD), top);
    let shown = view.rows.iter().skip(first).take(middle.height.into());
    let rows = shown.map(|row| {
        let style = match row.level() {
            _ if !has_colours => Style::new(),
            Level::Ok => Style::new(),
            Level::Warning => Style::new().fg(Color::Yellow),
            Level::Error => Style::new().fg(Color::Red),
            Level::Stale => Style::new().fg(Color::Magenta),
        };
        Row::new(cells(row)).style(style)
    });
    let widths = [
        Constraint::Length(16),
        Constraint::Fill(2),
        Constraint::Length(10),
        Constraint::Length(8),
        Constraint::Fill(1),
        Constraint::Fill(1),
    ];
    let columns = Row::new(COLUMNS).style(Modifier::UNDERLINED);
    frame.render_widget(Table::new(rows, widths).header(columns), middle);
    let keys = "This program drives no robot. Up, Down, Page keys: scroll. Q: end";
    frame.render_widget(Line::raw(keys), bottom);
}

#[cfg(test)]
mod tests {
    use ratatui::{Terminal, backend::TestBackend};

    use super::*;
    use crate::fleet::watch::Watch;

    #[test]
    fn the_screen_has_a_line_for_each_robot_and_scrolls() {
        let now = Instant::now();
        let mut watch = Watch::default();
        for number in 0..30 {
            watch.take_token(now, &format!("motorlink/@alive/r{number:02}/a1"), true);
        }
        let view = View {
            rows: watch.rows(now),
            ignored: 0,
            has_router: true,
        };
        let mut terminal = Terminal::new(TestBackend::new(100, 8)).unwrap();
        terminal.draw(|frame| draw(frame, &view, 4, false)).unwrap();
        let text = terminal.backend().to_string();
        let lines: Vec<_> = text.lines().collect();
        assert!(lines[0].contains("30 robots, 0 driving, 0 with problems, 30 not heard"));
        assert!(
            lines[2].contains("r04") && lines[2].contains("not heard"),
            "{text}"
        );
        assert!(
            lines[6].contains("r08") && lines[7].contains("Q: end"),
            "{text}"
        );
    }
}
