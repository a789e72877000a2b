use super::*;

/// A machine on which drawing at each rate makes so many of 100 exchanges a second late.
struct Machine {
    now: Instant,
    governor: Governor,
    /// At the full rate, 30, 20 and 10 frames a second.
    late: [u16; 4],
    exchanges_hz: u16,
}

impl Machine {
    fn new(late: [u16; 4]) -> Self {
        Self {
            now: Instant::from_millis(10_000),
            governor: Governor::default(),
            late,
            exchanges_hz: 100,
        }
    }

    fn look(&mut self) -> FrameRate {
        let [full, hz30, hz20, hz10] = self.late;
        let late_hz = match self.governor.rate {
            FrameRate::Full => full,
            FrameRate::Hz30 => hz30,
            FrameRate::Hz20 => hz20,
            FrameRate::Hz10 => hz10,
        };
        let line = LineStatus {
            exchanges_hz: self.exchanges_hz,
            late_hz,
            ..LineStatus::default()
        };
        self.governor.look(self.now, Some(&line))
    }

    /// The rate of each of so many seconds. The page looks in every frame.
    fn seconds(&mut self, seconds: u64) -> Vec<FrameRate> {
        let mut rates = Vec::new();
        for _ in 0..seconds {
            for _ in 0..60 {
                self.now = self.now + Duration::from_micros(16_667);
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

#[test]
fn where_nothing_is_late_nothing_changes() {
    let mut machine = Machine::new([0, 0, 0, 0]);
    let rates = machine.seconds(120);
    assert!(rates.iter().all(|rate| *rate == FrameRate::Full));
}

#[test]
fn the_rate_goes_down_a_step_a_second_until_the_wire_is_on_time() {
    let mut machine = Machine::new([20, 10, 1, 0]);
    let rates = machine.seconds(4);
    assert_eq!(
        rates[..3],
        [FrameRate::Hz30, FrameRate::Hz20, FrameRate::Hz20]
    );
}

#[test]
fn it_goes_up_again_when_the_machine_is_free_and_not_before_five_seconds() {
    let mut machine = Machine::new([20, 1, 0, 0]);
    assert_eq!(machine.rate_after(4), FrameRate::Hz30);
    machine.late = [0; 4];
    machine.governor.calm_since = None;
    assert_eq!(machine.rate_after(5), FrameRate::Hz30);
    assert_eq!(machine.rate_after(3), FrameRate::Full);
}

#[test]
fn a_rate_that_was_raised_too_soon_is_raised_less_and_less_often() {
    let mut machine = Machine::new([20, 0, 0, 0]);
    let rates = machine.seconds(300);
    let raised = rates
        .windows(2)
        .filter(|pair| pair[0] == FrameRate::Hz30 && pair[1] == FrameRate::Full)
        .count();
    // After 5, 10, 20, 40, 80 and 80 seconds.
    assert!((4..=6).contains(&raised), "{raised} times");
}

#[test]
fn where_drawing_less_does_not_help_the_page_draws_as_before() {
    // An adapter that holds bytes.
    let mut machine = Machine::new([60, 60, 60, 60]);
    assert_eq!(machine.rate_after(3), FrameRate::Hz10);
    let rates = machine.seconds(50);
    assert!(rates.iter().skip(2).all(|rate| *rate == FrameRate::Full));
    let rates = machine.seconds(20);
    assert!(rates.contains(&FrameRate::Hz10), "tries again in a minute");
}

#[test]
fn where_it_helps_in_part_the_rate_stays_low() {
    let mut machine = Machine::new([60, 50, 40, 20]);
    let rates = machine.seconds(60);
    assert!(rates.iter().skip(3).all(|rate| *rate == FrameRate::Hz10));
}

#[test]
fn while_nothing_is_driven_the_page_draws_fully_and_remembers_what_was_right() {
    let mut machine = Machine::new([20, 0, 0, 0]);
    assert_eq!(machine.rate_after(3), FrameRate::Hz30);
    machine.exchanges_hz = 10;
    assert_eq!(machine.rate_after(3), FrameRate::Full);
    machine.exchanges_hz = 100;
    assert_eq!(machine.look(), FrameRate::Hz30);
}

#[test]
fn another_connection_begins_anew() {
    let mut machine = Machine::new([20, 0, 0, 0]);
    assert_eq!(machine.rate_after(3), FrameRate::Hz30);
    assert_eq!(machine.governor.look(machine.now, None), FrameRate::Full);
    assert_eq!(machine.look(), FrameRate::Full);
}
