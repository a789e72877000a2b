//! What the stories share: a page that is connected, and how its read-outs are read.
#![allow(
    dead_code,
    clippy::missing_errors_doc,
    missing_docs,
    reason = "each story uses the part that it needs"
)]

pub mod exports;
pub mod rules;

use std::time::Duration;

use anyhow::{Result, ensure};
use end_to_end::{Adapter, Bench, Line, PATIENCE, Page, Usb, WireLog, now_us, wait_until};

/// A page whose real Web Serial port leads to these virtual motors.
pub struct Story {
    pub bench: Bench,
    pub adapter: Adapter,
    pub page: Page,
}

impl Story {
    pub fn connected(line: Line) -> Result<Self> {
        let bench = Bench::start()?;
        let adapter = bench.plug(line, Usb::default())?;
        let page = bench.open("/")?;
        connect(&page)?;
        Ok(Self {
            bench,
            adapter,
            page,
        })
    }

    /// Driving at +100 rpm and as fast.
    pub fn spinning() -> Result<Self> {
        let story = Self::connected(Line::default())?;
        spin(&story.page, "+100", 97..=103)?;
        Ok(story)
    }

    /// What went over the wire since a moment of [`now_us`].
    pub fn since(&self, us: u64) -> Result<WireLog> {
        Ok(self.adapter.wire()?.since(us))
    }

    /// Nothing drives for this long.
    pub fn stays_undriven(&self, duration: Duration) -> Result<()> {
        let from = now_us();
        std::thread::sleep(duration);
        let drives = self.since(from)?.drives();
        ensure!(drives.is_empty(), "driven by nobody's command:\n{drives}");
        Ok(())
    }
}

/// Presses Connect and waits for the first report of the motor.
pub fn connect(page: &Page) -> Result<()> {
    page.click("button", "Connect")?;
    page.wait_for_text("status", "Connection", |text| text.contains("Connected"))?;
    page.wait_for_text("output", "Speed", |text| number(text).is_some())?;
    Ok(())
}

/// The first number of a read-out, with its sign; `None` while it shows that none is known.
pub fn number(text: &str) -> Option<f64> {
    let plain = text.replace('\u{2212}', "-").replace('+', "");
    let from = plain.find(|c: char| c.is_ascii_digit())?;
    let signed = if plain[..from].ends_with('-') {
        from - 1
    } else {
        from
    };
    let rest = &plain[signed..];
    let part = |c: char| c.is_ascii_digit() || c == '-' || c == '.';
    rest[..rest.find(|c| !part(c)).unwrap_or(rest.len())]
        .parse()
        .ok()
}

pub fn wait_for_speed(page: &Page, rpm: std::ops::RangeInclusive<i32>) -> Result<()> {
    wait_for_speed_within(page, PATIENCE, rpm)
}

fn wait_for_speed_within(
    page: &Page,
    patience: Duration,
    rpm: std::ops::RangeInclusive<i32>,
) -> Result<()> {
    let within = |text: &str| {
        number(text)
            .is_some_and(|speed| f64::from(*rpm.start()) <= speed && speed <= f64::from(*rpm.end()))
    };
    page.wait_for_text_within(patience, "output", "Speed", within)?;
    Ok(())
}

/// A wheel is at speed in half a second; a busy page shows it a little later.
const SPIN_UP_MAX: Duration = Duration::from_secs(5);
const PRESSES_MAX: u32 = 3;

/// Presses a button that drives, and waits until the wheel is as fast. Where the machine was held up and the
/// motor was lost for a moment, the page says so and a person presses again.
pub fn spin(page: &Page, button: &str, rpm: std::ops::RangeInclusive<i32>) -> Result<()> {
    for _ in 0..PRESSES_MAX {
        page.click("button", button)?;
        if wait_for_speed_within(page, SPIN_UP_MAX, rpm.clone()).is_ok() {
            return Ok(());
        }
        rules::the_page_says_one_of(page, &rules::LOST)?;
        eprintln!("{button} is pressed once more: the motor was lost for a moment");
    }
    wait_for_speed(page, rpm)
}

/// Waits until the wire since a moment is as it should be, and gives it.
pub fn wait_for_wire(
    story: &Story,
    since: u64,
    what: &str,
    wanted: impl Fn(&WireLog) -> bool,
) -> Result<WireLog> {
    wait_until(what, PATIENCE, || {
        let wire = story.since(since)?;
        Ok(if wanted(&wire) {
            Ok(wire)
        } else {
            Err(format!("\n{wire}"))
        })
    })
}

/// Waits until a control can be pressed, or until it cannot.
pub fn wait_until_enabled(page: &Page, role: &str, name: &str, enabled: bool) -> Result<()> {
    let how = if enabled { "enabled" } else { "disabled" };
    wait_until(&format!("{role} {name:?} to be {how}"), PATIENCE, || {
        let control = page.find(role, name)?;
        Ok(if control.disabled == enabled {
            Err(control.description)
        } else {
            Ok(())
        })
    })
}

/// Has a panel of the drawer lie open.
pub fn open_panel(page: &Page, name: &str) -> Result<()> {
    if page.find_all("region", name)?.is_empty() {
        page.click("button", name)?;
    }
    Ok(())
}

/// The console of a page that has nothing to complain about.
pub fn assert_quiet_console(page: &Page) {
    assert_eq!(page.console_errors(), Vec::<String>::new());
}

/// The drive frames of this log are stops, and the last one brakes.
pub fn assert_ends_braked(wire: &WireLog) {
    let drives = wire.drives();
    let last = drives.last().expect("a drive frame");
    assert!(
        last.brakes(),
        "the last drive frame does not brake:\n{wire}"
    );
}
