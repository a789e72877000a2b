//! Plays a scenario over virtual time and checks the rules after every step.
//!
//! | file | idea |
//! |---|---|
//! | `acting` | what the actions of a scenario do |
//! | `sequences` | the run of a sequence beside the bus |
//! | `wire` | bytes to the bus, frames to the wire |
//! | `ending` | everything stops, and stays so |

mod acting;
mod ending;
mod sequences;
mod wire;

use std::collections::{BTreeMap, VecDeque};
use std::ops::AddAssign;
use std::time::Duration;

use crc::{CRC_64_XZ, Crc, Digest};
use motorlink_bus::{Bus, BusSettings, Command, Event, LeftDriven, Output};
use motorlink_protocol::family::Model;
use motorlink_protocol::{Instant, MotorId};
use motorlink_simulator::{MotorConfig, World, WorldConfig};

use crate::action::{Fault, LineFault};
use crate::rule::{Rule, Violation};
use crate::rules::Rules;
use crate::scenario::Scenario;
use crate::sequence_run::{Answers, Runs, SequenceRun};

/// Most steps of the bus at one moment: far above the usual number, and far below a busy loop.
const STEPS_AT_ONCE_MAX: u32 = 2_000;
/// Most wake-ups per second: four per exchange at the highest rate of the line.
const WAKES_A_SECOND_MAX: u32 = 2_400;
/// Mode switch frames for a motor that needs many.
const MANY_SWITCHES: u8 = 5;
/// The speed that a motor was seen to report for ever: `waveshareteam/ddsm_example#2`.
const STUCK_RPM: f32 = -0.1;

/// Of the frames that a bus sent.
static SENT: Crc<u64> = Crc::<u64>::new(&CRC_64_XZ);

/// Coverage of the played scenarios.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Coverage {
    /// How often each fault happened.
    pub faults: BTreeMap<Fault, u64>,
    /// How often each rule was applied.
    pub judged: BTreeMap<Rule, u64>,
    /// How the runs of sequences ended.
    pub runs: Runs,
    /// The frames that the bus sent, with their times: equal for two programs that do the same in each world, in
    /// whatever order the worlds are played.
    pub sent: u64,
}

impl AddAssign for Coverage {
    fn add_assign(&mut self, other: Self) {
        self.runs += other.runs;
        self.sent = self.sent.wrapping_add(other.sent);
        for (fault, times) in other.faults {
            *self.faults.entry(fault).or_default() += times;
        }
        for (rule, times) in other.judged {
            *self.judged.entry(rule).or_default() += times;
        }
    }
}

/// Where a scenario broke a rule.
#[derive(Clone, Debug, PartialEq)]
pub struct Failure {
    /// Number of the last action before it, from 0.
    pub step: usize,
    /// The broken rule.
    pub violation: Violation,
}

/// Plays a scenario to its end, or to the first broken rule.
///
/// # Errors
///
/// The broken rule, and the action at which it broke.
pub fn play(scenario: &Scenario, coverage: &mut Coverage) -> Result<(), Failure> {
    let mut player = Player::new(scenario);
    let mut count = |fault, times: usize| {
        if let Ok(times @ 1..) = u64::try_from(times) {
            *coverage.faults.entry(fault).or_default() += times;
        }
    };
    count(Fault::NeedsFiveSwitches, scenario.need_five_switches.len());
    count(Fault::SpeedStuck, scenario.speed_stuck.len());
    count(Fault::ObeysAll, usize::from(scenario.obey_all));
    count(Fault::of_firmware(scenario.when_silent), 1);
    for (step, action) in scenario.actions.iter().enumerate() {
        if let Some(fault) = action.fault() {
            *coverage.faults.entry(fault).or_default() += 1;
        }
        let outcome = player.apply(action);
        outcome.map_err(|violation| Failure { step, violation })?;
    }
    let ended = player.end();
    coverage.runs += player.runs;
    coverage.sent = coverage.sent.wrapping_add(player.sent.finalize());
    player.rules.judge(Rule::ComesToRest);
    for (rule, times) in &player.rules.judged {
        *coverage.judged.entry(*rule).or_default() += times;
    }
    let step = scenario.actions.len();
    ended.map_err(|violation| Failure { step, violation })
}

/// The last `lines` of the trace of a scenario, up to its end or the first broken rule.
#[must_use]
pub fn trace_lines(scenario: &Scenario, lines: usize) -> Vec<String> {
    let mut player = Player::new(scenario);
    player.passed = Some(VecDeque::with_capacity(lines));
    for action in &scenario.actions {
        player.note(|| format!("{action:?}"));
        if player.apply(action).is_err() {
            return player.passed.into_iter().flatten().collect();
        }
    }
    // `play` reports a broken rule.
    let _ = player.end();
    player.passed.into_iter().flatten().collect()
}

struct Player {
    now: Instant,
    world: World,
    /// `None` while the adapter is unplugged.
    bus: Option<Bus>,
    model: Model,
    /// Whether Stop all motors is in force. It outlives the port.
    halted: bool,
    line: LineFault,
    /// What is remembered if the bus is lost now: what was left driven before the last frame.
    left_driven: Vec<LeftDriven>,
    page_answers: bool,
    /// Commands that were clicked while the page hung, with their times.
    clicked: Vec<(Instant, Command)>,
    settings: BusSettings,
    rules: Rules,
    motors: Vec<MotorId>,
    /// Frames other than queries since the last check.
    acted: u64,
    /// Start of the current second, and the number of wake-ups in it.
    wakes: (Instant, u32),
    /// Latest time of the next call, as the bus asked.
    promised: Option<Instant>,
    /// Frames that the port will refuse.
    refuses: u8,
    /// The next frames to truncate: number of frames, bytes sent of each, and whether the port
    /// reports it.
    cuts: Option<(u8, usize, bool)>,
    /// The trace, if it is recorded; at most its initial capacity.
    passed: Option<VecDeque<String>>,
    /// The last sequence that was run.
    sequence: Option<SequenceRun>,
    runs: Runs,
    /// A check sum of the frames that the bus sent, and of their times.
    sent: Digest<'static, u64>,
}

impl Player {
    fn new(scenario: &Scenario) -> Self {
        let now = Instant::from_millis(1_000);
        let mut world = World::new(WorldConfig {
            seed: scenario.seed,
            motors: scenario
                .motors
                .iter()
                .map(|id| motor(scenario, *id))
                .collect(),
            ..WorldConfig::of(scenario.model, [])
        });
        world.advance(now);
        let mut player = Self {
            now,
            world,
            bus: None,
            model: scenario.model,
            halted: false,
            line: LineFault::None,
            left_driven: Vec::new(),
            page_answers: true,
            clicked: Vec::new(),
            settings: BusSettings::default(),
            rules: Rules::of(scenario.model, &scenario.speed_stuck),
            motors: scenario.motors.clone(),
            acted: 0,
            wakes: (now, 0),
            promised: None,
            refuses: 0,
            cuts: None,
            passed: None,
            sequence: None,
            runs: Runs::default(),
            sent: SENT.digest(),
        };
        player.rules.line(now, Some(LineFault::None));
        player.plug();
        player
    }

    /// A new bus, as the worker creates one for an open port.
    fn plug(&mut self) {
        let bus = Bus::with_model(self.now, self.model).after_another(self.now);
        let mut bus = if self.halted { bus.into_halted() } else { bus };
        let configure = Command::Configure(self.settings);
        let watched = self.motors.iter().copied().map(Command::Watch);
        self.rules.limits(self.settings.limits);
        self.promised = None;
        for command in watched.chain([configure]) {
            // A bus that drives nothing does not refuse this.
            let _: Result<(), _> = bus.command(self.now, command);
        }
        bus.stop_first(self.now, self.left_driven.iter().copied());
        self.bus = Some(bus);
        self.rules.port_opened(self.now, &self.world);
    }

    /// Advances the world to now and checks its motors.
    fn advance(&mut self) -> Result<(), Violation> {
        self.world.advance(self.now);
        self.rules.moved(self.now, &self.world)?;
        self.receive_replies();
        Ok(())
    }

    fn run(&mut self, duration: Duration) -> Result<(), Violation> {
        let end = self.now + duration;
        loop {
            self.turn_sequence()?;
            let wake = self.settle()?;
            self.rules.passed(self.now, &self.world)?;
            // An event may have ended the run.
            let run_wake = self.sequence.as_ref().and_then(SequenceRun::wake);
            let next = [Some(end), wake, self.world.next_event(), run_wake];
            let next = next.into_iter().flatten().min().unwrap_or(end);
            self.count_wake(wake.is_some_and(|wake| wake <= next))?;
            self.now = next.max(self.now);
            self.advance()?;
            while let Some(chunk) = self.world.receive(self.now) {
                self.hand_over(&chunk.bytes);
            }
            if self.now >= end {
                self.settle()?;
                return self.rules.passed(self.now, &self.world);
            }
        }
    }

    fn note(&mut self, what: impl FnOnce() -> String) {
        let now = self.now;
        if let Some(passed) = &mut self.passed {
            if passed.len() == passed.capacity() {
                passed.pop_front();
            }
            passed.push_back(format!("{now:?}  {}", what()));
        }
    }

    fn count_wake(&mut self, is_wake: bool) -> Result<(), Violation> {
        let (began, count) = &mut self.wakes;
        if self.now.since(*began) >= Duration::from_secs(1) {
            (*began, *count) = (self.now, 0);
        }
        *count += u32::from(is_wake);
        if *count > WAKES_A_SECOND_MAX {
            return self.restless("the bus asks to be woken again and again".to_owned());
        }
        Ok(())
    }

    /// Polls the bus. Returns when to poll it again.
    fn settle(&mut self) -> Result<Option<Instant>, Violation> {
        for _ in 0..STEPS_AT_ONCE_MAX {
            let Some(bus) = &mut self.bus else {
                return Ok(None);
            };
            match bus.poll(self.now) {
                Output::Transmit(frame) => self.transmit(frame)?,
                Output::Event(Event::PingPage) if self.page_answers => bus.page_answered(self.now),
                Output::Event(event) => {
                    self.note(|| format!("{event:?}"));
                    self.rules.on_event(self.now, &event, &self.world)?;
                    self.with_sequence(|run, now, bus, settings, _| match bus {
                        Some(bus) => run.on_event(now, &event, bus, settings),
                        None => Answers::new(),
                    })?;
                }
                Output::Wait(at) if at > self.now => {
                    self.rules.settled(self.now, bus, &self.world)?;
                    self.promised = Some(at);
                    return Ok(Some(at));
                }
                Output::Wait(_) => break,
            }
        }
        self.restless("the bus never rests".to_owned())
            .map(|()| None)
    }
}

/// A motor of a scenario.
fn motor(scenario: &Scenario, id: MotorId) -> MotorConfig {
    let default = MotorConfig::of(scenario.model, id);
    let mode_switch_frames = if scenario.need_five_switches.contains(&id) {
        MANY_SWITCHES
    } else {
        default.mode_switch_frames
    };
    MotorConfig {
        mode_switch_frames,
        obeys_all: scenario.obey_all,
        angle_deg: scenario.angle_deg,
        speed_stuck_rpm: scenario.speed_stuck.contains(&id).then_some(STUCK_RPM),
        when_silent: scenario.when_silent,
        ..default
    }
}
