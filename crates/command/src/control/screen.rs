//! What `control` shows.

use std::collections::{BTreeMap, VecDeque};

use motorlink_bus::MotorStatus;
use motorlink_driver::Status;
use motorlink_protocol::{MotorId, family::Model};
use ratatui::{
    Frame,
    layout::{Constraint, Layout, Rect},
    style::{Color, Modifier, Style},
    text::Line,
    widgets::{Block, Paragraph, Sparkline},
};

use crate::{signed_id::SignedId, values::Values};

/// Speeds of a sparkline: ten seconds at ten drawings a second.
const SPEEDS: usize = 100;
/// Notices that are kept.
const NOTICES: usize = 50;

const KEYS: &str = "F/B forward, back  1-5 50-250 rpm  ←/→ ±10  S stop  K brake  Space stop all  R release  ↑/↓ motor  G group  Q quit";

/// What is shown beside the state of the line.
#[derive(Debug)]
pub struct Screen {
    pub motors: Vec<SignedId>,
    pub selected: usize,
    pub is_group: bool,
    /// Whether keys latch.
    pub latches: bool,
    model: Model,
    has_colours: bool,
    speeds: BTreeMap<MotorId, VecDeque<u64>>,
    notices: VecDeque<String>,
}

impl Screen {
    pub fn new(motors: Vec<SignedId>, model: Model, latches: bool) -> Self {
        Self {
            motors,
            selected: 0,
            is_group: false,
            latches,
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

    /// Notes the speeds of this moment.
    pub fn record(&mut self, status: &Status) {
        for motor in &status.motors {
            let speeds = self.speeds.entry(motor.id).or_default();
            let speed = motor.speed.map_or(0, |(_, speed)| speed.magnitude());
            speeds.push_back(speed.into());
            if speeds.len() > SPEEDS {
                speeds.pop_front();
            }
        }
    }

    fn colour(&self, colour: Color) -> Style {
        if self.has_colours {
            Style::new().fg(colour)
        } else {
            Style::new()
        }
    }

    /// Draws the state of the line.
    pub fn draw(&self, frame: &mut Frame<'_>, status: &Status) {
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
        self.draw_head(frame, head, status);
        self.draw_motors(frame, motors, status);
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
            Paragraph::new(KEYS).wrap(ratatui::widgets::Wrap { trim: true }),
            keys,
        );
    }

    fn draw_head(&self, frame: &mut Frame<'_>, area: Rect, status: &Status) {
        let text = if !status.is_open {
            ("The port is gone. Waiting for it.".to_owned(), Color::Red)
        } else if status.is_halted {
            ("STOPPED: all motors. R releases.".to_owned(), Color::Red)
        } else {
            let line = status.line;
            let hertz = line.map_or(0, |line| line.exchanges_hz);
            let keys = if self.latches {
                "keys latch"
            } else {
                "hold a key to run"
            };
            (
                format!(
                    "MotorLink  {}  {hertz} exchanges a second  {keys}",
                    self.model
                ),
                Color::Green,
            )
        };
        frame.render_widget(Paragraph::new(text.0).style(self.colour(text.1)), area);
    }

    fn draw_motors(&self, frame: &mut Frame<'_>, area: Rect, status: &Status) {
        let title = if self.is_group {
            " Motors, driven together "
        } else {
            " Motors "
        };
        let block = Block::bordered().title(title);
        let inner = block.inner(area);
        frame.render_widget(block, area);
        let mut at = Rect { height: 1, ..inner };
        frame.render_widget(Paragraph::new(format!("  {}", Values::HEAD)), at);
        for (place, signed) in self.motors.iter().enumerate() {
            at.y += 1;
            let is_selected = self.is_group || place == self.selected;
            let mark = if is_selected { ">" } else { " " };
            let motor: Option<&MotorStatus> =
                status.motors.iter().find(|motor| motor.id == signed.id);
            let text = motor.map_or_else(
                || format!("{signed:>5}  no reply yet"),
                |motor| Values::of(self.model, motor, status.now, *signed).line(),
            );
            let mut style = if motor.is_some_and(|motor| motor.turns_unasked || motor.silent) {
                self.colour(Color::Red)
            } else {
                Style::new()
            };
            if is_selected {
                style = style.add_modifier(Modifier::BOLD);
            }
            if at.bottom() <= inner.bottom() {
                frame.render_widget(Paragraph::new(format!("{mark} {text}")).style(style), at);
            }
            at.y += 1;
            if let Some(speeds) = self.speeds.get(&signed.id)
                && at.bottom() <= inner.bottom()
            {
                let data: Vec<u64> = speeds.iter().copied().collect();
                let most = u64::from(self.model.spec().nominal.no_load_rpm);
                let line = Sparkline::default()
                    .data(&data)
                    .max(most)
                    .style(self.colour(Color::Cyan));
                frame.render_widget(
                    line,
                    Rect {
                        x: at.x + 9,
                        width: at.width.saturating_sub(9),
                        ..at
                    },
                );
            }
        }
    }
}
