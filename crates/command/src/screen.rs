//! The full screen: what the motors report, and their speeds of the last seconds.

use std::{
    collections::{BTreeMap, VecDeque},
    mem,
    ops::Range,
    time::Duration,
};

use motorlink_bus::{FRESH_FOR, MotorStatus};
use motorlink_driver::Status;
use motorlink_protocol::{Instant, MotorId, Rpm, family::Model};
use ratatui::{
    DefaultTerminal, Frame,
    layout::{Constraint, Layout, Rect},
    style::{Color, Modifier, Style},
    text::Line,
    widgets::{Block, Paragraph, Sparkline, Wrap},
};

use crate::{failure::Failure, key_input::KeyInput, signed_id::SignedId, values::Values};

/// What a column of a sparkline shows: ten are a second.
const COLUMN: Duration = Duration::from_millis(100);
/// Speeds that are kept: as many columns as a wide terminal has.
const KEPT: Duration = Duration::from_secs(30);
/// Notices that are kept.
const NOTICES: usize = 50;

/// Takes the whole terminal for `work`, and restores it whatever comes. `otherwise` is what to use without a terminal.
///
/// # Errors
/// There is no terminal, or `work` has failed.
pub fn on_full_screen(
    otherwise: &str,
    work: impl FnOnce(&mut DefaultTerminal, &KeyInput) -> Result<(), Failure>,
) -> Result<(), Failure> {
    let none = |error| Failure::Usage(format!("there is no terminal ({error}): {otherwise}"));
    let keys = KeyInput::open().map_err(none)?;
    // It also restores the terminal before a panic is printed.
    let mut terminal = ratatui::try_init().map_err(|error| {
        let _ = ratatui::try_restore();
        none(error)
    })?;
    let done = work(&mut terminal, &keys);
    if ratatui::try_restore().is_err() {
        // The terminal is gone. `Terminal::drop` would print its error there, and panic before the motors stand.
        mem::forget(terminal);
    }
    done
}

/// What is shown beside the state of the line.
#[derive(Debug)]
pub struct Screen {
    pub motors: Vec<SignedId>,
    pub model: Model,
    has_colours: bool,
    speeds: BTreeMap<MotorId, BTreeMap<Instant, u64>>,
    notices: VecDeque<String>,
}

/// What is around the motors.
#[derive(Debug)]
pub struct Around {
    /// The first line.
    pub head: String,
    /// Its colour.
    pub colour: Color,
    /// Over the motors.
    pub title: String,
    /// The places of motors with a mark.
    pub marked: Range<usize>,
    /// What the keys do.
    pub keys: String,
}

impl Screen {
    pub fn new(motors: Vec<SignedId>, model: Model) -> Self {
        Self {
            motors,
            model,
            // https://no-color.org
            has_colours: std::env::var_os("NO_COLOR").is_none_or(|value| value.is_empty()),
            speeds: BTreeMap::new(),
            notices: VecDeque::new(),
        }
    }

    /// Adds a line at the bottom.
    pub fn notice(&mut self, text: String) {
        self.notices.push_back(text);
        if self.notices.len() > NOTICES {
            self.notices.pop_front();
        }
    }

    /// Removes the lines at the bottom.
    pub fn clear_notices(&mut self) {
        self.notices.clear();
    }

    /// Notes a speed of that moment. They may come in any order.
    pub fn speed(&mut self, id: MotorId, at: Instant, speed: Rpm) {
        let speeds = self.speeds.entry(id).or_default();
        speeds.insert(at, speed.magnitude().into());
        if let Some((last, _)) = speeds.last_key_value() {
            *speeds = speeds.split_off(&(*last - KEPT));
        }
    }

    /// Forgets all speeds.
    pub fn clear_speeds(&mut self) {
        self.speeds.clear();
    }

    fn colour(&self, colour: Color) -> Style {
        if self.has_colours {
            Style::new().fg(colour)
        } else {
            Style::new()
        }
    }

    /// Draws the state of the line.
    pub fn draw(&self, frame: &mut Frame<'_>, status: &Status, around: &Around) {
        let rows = u16::try_from(self.motors.len())
            .unwrap_or(16)
            .saturating_mul(2);
        let areas = Layout::vertical([
            Constraint::Length(1),
            Constraint::Length(rows + 3),
            Constraint::Min(2),
            Constraint::Length(2),
        ]);
        let [head, motors, notices, keys] = areas.areas(frame.area());
        let style = self.colour(around.colour);
        frame.render_widget(Paragraph::new(around.head.as_str()).style(style), head);
        self.draw_motors(frame, motors, status, around);
        let height = usize::from(notices.height.saturating_sub(1));
        let skipped = self.notices.len().saturating_sub(height);
        let lines: Vec<Line<'_>> = self
            .notices
            .iter()
            .skip(skipped)
            .map(|text| Line::raw(text.as_str()))
            .collect();
        frame.render_widget(
            Paragraph::new(lines).block(Block::new().title("Events")),
            notices,
        );
        frame.render_widget(
            Paragraph::new(around.keys.as_str()).wrap(Wrap { trim: true }),
            keys,
        );
    }

    fn draw_motors(&self, frame: &mut Frame<'_>, area: Rect, status: &Status, around: &Around) {
        let inner = Block::bordered().inner(area);
        // The selected motor stays in sight.
        let room = usize::from(inner.height.saturating_sub(1) / 2).max(1);
        let all = self.motors.len();
        let first = (around.marked.start + 1).saturating_sub(room);
        let title = if all > room {
            let (from, to) = (first + 1, (first + room).min(all));
            format!("{}, {from} to {to} of {all}", around.title)
        } else {
            around.title.clone()
        };
        frame.render_widget(Block::bordered().title(title), area);
        let mut at = Rect { height: 1, ..inner };
        frame.render_widget(Paragraph::new(format!("  {}", Values::HEAD)), at);
        for (place, signed) in self.motors.iter().enumerate().skip(first) {
            at.y += 1;
            let is_marked = around.marked.contains(&place);
            let mark = if is_marked { ">" } else { " " };
            let motor: Option<&MotorStatus> = status.motor(signed.id);
            let text = motor.map_or_else(
                || format!("{:>5}  no reply yet", signed.to_string()),
                |motor| Values::of(self.model, motor, status.now, *signed).line(),
            );
            let mut style = if motor.is_some_and(|motor| motor.turns_unasked || motor.is_silent()) {
                self.colour(Color::Red)
            } else {
                Style::new()
            };
            if is_marked {
                style = style.add_modifier(Modifier::BOLD);
            }
            if at.bottom() <= inner.bottom() {
                frame.render_widget(Paragraph::new(format!("{mark} {text}")).style(style), at);
            }
            at.y += 1;
            if at.bottom() <= inner.bottom() {
                let line = Rect {
                    x: at.x + 9,
                    width: at.width.saturating_sub(9),
                    ..at
                };
                let speeds = self.columns(signed.id, status.now, line.width);
                let most = u64::from(self.model.spec().nominal.no_load_rpm);
                let sparkline = Sparkline::default().data(&speeds).max(most);
                frame.render_widget(sparkline.style(self.colour(Color::Cyan)), line);
            }
        }
    }

    /// The speeds until now, one for each column. Zero where none is known.
    fn columns(&self, id: MotorId, now: Instant, columns: u16) -> Vec<u64> {
        let Some(speeds) = self.speeds.get(&id) else {
            return Vec::new();
        };
        let speed_at = |back: u16| {
            let at = now - COLUMN * back.into();
            let (known_at, speed) = speeds.range(..=at).next_back()?;
            (at.since(*known_at) <= FRESH_FOR).then_some(*speed)
        };
        let backwards = (0..columns).rev();
        backwards.map(|back| speed_at(back).unwrap_or(0)).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_selected_motor_is_in_sight_and_the_others_are_counted() {
        let ids = (1..=16).flat_map(MotorId::new).map(SignedId::straight);
        let screen = Screen::new(ids.collect(), Model::Ddsm115);
        let status = Status {
            now: Instant::ZERO,
            is_open: true,
            is_halted: false,
            stops_begun: 0,
            motors: Vec::new(),
            job: None,
            raw: None,
            line: None,
        };
        for (selected, size, title) in [
            (0, (80, 24), "motors, 1 to 8 of 16"),
            (11, (80, 24), "motors, 5 to 12 of 16"),
            (15, (40, 10), "motors, 16 to 16 of 16"),
        ] {
            let around = Around {
                head: String::new(),
                colour: Color::Green,
                title: "motors".to_owned(),
                marked: selected..selected + 1,
                keys: String::new(),
            };
            let backend = ratatui::backend::TestBackend::new(size.0, size.1);
            let mut terminal = ratatui::Terminal::new(backend).unwrap();
            terminal
                .draw(|frame| screen.draw(frame, &status, &around))
                .unwrap();
            let shown = terminal.backend().to_string();
            assert!(shown.contains(title), "{shown}");
            let id = screen.motors[selected];
            assert!(shown.contains(&format!(">  {id}")), "{shown}");
        }
    }

    #[test]
    fn a_column_has_the_speed_of_its_moment_and_none_that_is_old() {
        let mut screen = Screen::new(Vec::new(), Model::Ddsm115);
        let at = |ms: u64| Instant::from_millis(60_000 + ms);
        // A replay learns what was before a jump behind what comes next.
        for (ms, rpm) in [(1_000, 20), (0, -10), (60, 11)] {
            screen.speed(MotorId::FIRST, at(ms), Rpm::new(rpm));
        }
        let columns = |ms: u64, count: u16| screen.columns(MotorId::FIRST, at(ms), count);
        assert_eq!(columns(1_000, 3), [0, 0, 20]);
        assert_eq!(columns(100, 3), [0, 10, 11]);
        assert_eq!(columns(500, 2), [11, 11]);
        assert!(screen.columns(MotorId::LAST, at(0), 3).is_empty());
    }
}
