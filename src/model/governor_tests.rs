use std::time::Duration;

use super::*;

/// A machine on which drawing at each rate makes so many per mille of the exchanges late.
struct Machine {
    now: Instant,
    governor: Governor,
    /// At the full rate, 30, 20 and 10 frames a second.
    late: [u32; 4],
    exchanges_hz: u16,
    is_hidden: bool,
    /// Where there is one, lateness is random around those figures.
    seed: Option<u64>,
}

impl Machine {
    fn new(late: [u32; 4]) -> Self {
        let mut machine = Self {
            now: Instant::from_millis(10_000),
            governor: Governor::default(),
            late,
            exchanges_hz: 60,
            is_hidden: false,
            seed: None,
        };
        // The wheel that is driven begins with the first second.
        let late = std::mem::take(&mut machine.late);
        machine.seconds(2);
        machine.late = late;
        machine
    }

    fn random(late: [u32; 4]) -> Self {
        Self {
            seed: Some(1),
            ..Self::new(late)
        }
    }

    /// Below so many, by xorshift.
    fn below(&mut self, most: u32) -> Option<u32> {
        let seed = self.seed.as_mut()?;
        *seed ^= *seed << 13;
        *seed ^= *seed >> 7;
        *seed ^= *seed << 17;
        u32::try_from(*seed % u64::from(most)).ok()
    }

    fn late_hz(&mut self) -> u16 {
        let [full, hz30, hz20, hz10] = self.late;
        let per_mille = match self.governor.rate {
            FrameRate::Full => full,
            FrameRate::Hz30 => hz30,
            FrameRate::Hz20 => hz20,
            FrameRate::Hz10 => hz10,
        };
        let exchanges = u32::from(self.exchanges_hz);
        let late = if self.seed.is_some() {
            let chance = (0..exchanges).filter(|_| self.below(1_000) < Some(per_mille));
            chance.count()
        } else {
            (exchanges * per_mille / 1_000) as usize
        };
        u16::try_from(late).unwrap()
    }

    fn look(&mut self) -> FrameRate {
        let line = LineStatus {
            exchanges_hz: self.exchanges_hz,
            late_hz: self.late_hz(),
            ..LineStatus::default()
        };
        self.governor.look(self.now, Some(&line), self.is_hidden)
    }

    /// The rate of each of so many seconds. The page looks at every update.
    fn seconds(&mut self, seconds: u64) -> Vec<FrameRate> {
        let mut rates = Vec::new();
        for _ in 0..seconds {
            for _ in 0..20 {
                self.now = self.now + Duration::from_millis(50);
                self.look();
            }
            rates.push(self.look());
        }
        rates
    }

    fn rate_after(&mut self, seconds: u64) -> FrameRate {
        self.seconds(seconds).pop().unwrap()
    }
}

fn share(rates: &[FrameRate], of: FrameRate) -> f64 {
    let count = rates.iter().filter(|rate| **rate == of).count();
    f64::from(u32::try_from(count).unwrap()) / f64::from(u32::try_from(rates.len()).unwrap())
}

#[test]
fn where_nothing_is_late_nothing_changes() {
    let rates = Machine::new([0; 4]).seconds(120);
    assert!(rates.iter().all(|rate| *rate == FrameRate::Full));
}

/// A machine is late now and then whatever is drawn.
#[test]
fn a_few_late_exchanges_change_nothing() {
    for late in [5, 10, 20] {
        let rates = Machine::random([late; 4]).seconds(2_000);
        let full = share(&rates, FrameRate::Full);
        assert!(full > 0.9, "{late} per mille late: {full}");
    }
}

#[test]
fn the_rate_goes_down_a_step_in_three_seconds_until_the_wire_is_on_time() {
    let mut machine = Machine::new([200, 100, 10, 0]);
    let mut rates = machine.seconds(9);
    rates.dedup();
    let down = [FrameRate::Full, FrameRate::Hz30, FrameRate::Hz20];
    assert!(down.ends_with(&rates), "{rates:?}");
    assert_eq!(machine.rate_after(3), FrameRate::Hz20);
}

#[test]
fn it_goes_up_again_when_the_machine_is_free_and_not_before_five_seconds() {
    let mut machine = Machine::new([200, 20, 0, 0]);
    assert_eq!(machine.rate_after(4), FrameRate::Hz30);
    machine.late = [0; 4];
    machine.governor.restart();
    assert_eq!(machine.rate_after(5), FrameRate::Hz30);
    assert_eq!(machine.rate_after(6), FrameRate::Full);
}

#[test]
fn a_rate_that_was_raised_too_soon_is_raised_less_and_less_often() {
    let mut machine = Machine::new([200, 0, 0, 0]);
    let rates = machine.seconds(300);
    let raised = rates
        .windows(2)
        .filter(|pair| pair[0] == FrameRate::Hz30 && pair[1] == FrameRate::Full)
        .count();
    // After 5, 10, 20, 40, 80 and 80 seconds.
    assert!((4..=6).contains(&raised), "{raised} times");
    // Nothing is late any more, and the next time it is the wait is short again.
    machine.late = [0; 4];
    assert_eq!(machine.rate_after(100), FrameRate::Full);
    machine.late = [200, 0, 0, 0];
    assert_eq!(machine.rate_after(4), FrameRate::Hz30);
    machine.late = [0; 4];
    assert_eq!(machine.rate_after(12), FrameRate::Full);
}

#[test]
fn where_drawing_less_does_not_help_the_page_draws_as_before() {
    // An adapter that holds bytes.
    let mut machine = Machine::random([600; 4]);
    let rates = machine.seconds(600);
    let full = share(&rates, FrameRate::Full);
    assert!(full > 0.8, "{full}");
    assert!(
        rates.contains(&FrameRate::Hz10),
        "it tries again each minute"
    );
}

#[test]
fn where_drawing_less_helps_in_part_the_rate_stays_low() {
    let mut machine = Machine::random([250, 180, 120, 80]);
    machine.seconds(10);
    let rates = machine.seconds(1_000);
    let low = share(&rates, FrameRate::Hz10);
    assert!(low > 0.8, "{low}");
}

#[test]
fn while_nothing_is_driven_the_page_draws_fully_and_remembers_what_was_right() {
    let mut machine = Machine::new([200, 0, 0, 0]);
    assert_eq!(machine.rate_after(4), FrameRate::Hz30);
    machine.exchanges_hz = 10;
    assert_eq!(machine.rate_after(30), FrameRate::Full);
    machine.exchanges_hz = 60;
    // Rest was no calm.
    assert_eq!(machine.rate_after(5), FrameRate::Hz30);
}

/// Around the limit the rate does not flicker.
#[test]
fn what_is_between_resting_and_working_changes_nothing() {
    let mut machine = Machine::new([200, 0, 0, 0]);
    assert_eq!(machine.rate_after(4), FrameRate::Hz30);
    for exchanges_hz in [21, 29, 22, 28] {
        machine.exchanges_hz = exchanges_hz;
        assert_eq!(machine.rate_after(1), FrameRate::Hz30);
    }
    machine.exchanges_hz = 10;
    assert_eq!(machine.rate_after(1), FrameRate::Full);
    machine.exchanges_hz = 25;
    assert_eq!(machine.rate_after(3), FrameRate::Full);
}

#[test]
fn nothing_follows_from_the_time_of_a_hidden_page_or_of_a_hang() {
    let mut machine = Machine::new([200, 0, 0, 0]);
    assert_eq!(machine.rate_after(4), FrameRate::Hz30);
    machine.is_hidden = true;
    assert_eq!(machine.rate_after(60), FrameRate::Hz30);
    machine.is_hidden = false;
    assert_eq!(machine.rate_after(4), FrameRate::Hz30);
    machine.now = machine.now + Duration::from_secs(60);
    assert_eq!(machine.look(), FrameRate::Hz30);
}

#[test]
fn another_connection_starts_again() {
    let mut machine = Machine::new([200, 0, 0, 0]);
    assert_eq!(machine.rate_after(4), FrameRate::Hz30);
    assert_eq!(
        machine.governor.look(machine.now, None, false),
        FrameRate::Full
    );
    assert_eq!(machine.look(), FrameRate::Full);
}
