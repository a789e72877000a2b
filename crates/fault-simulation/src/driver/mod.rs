//! The native driver on a computer that fails: ports that refuse, stall and vanish, processes that are killed, disks that
//! are full. Its processes run one after the other on the same motors, in virtual time.
//!
//! | file | idea |
//! |---|---|
//! | `scenario` | generates processes and what happens to them from a seed |
//! | `machine`, `acting` | the state of the computer, and what happens to it |
//! | `computer` | the same, as the driver has it |
//! | `port` | the port of that computer |
//! | `rule` | what must hold, by name |
//! | `rules`, `checks` | what the rules know, and their checks |

use std::{cell::RefCell, collections::BTreeMap, ops::AddAssign, rc::Rc};

use motorlink_driver::{Options, Place, run_on};

mod acting;
mod checks;
mod computer;
mod machine;
mod port;
mod rule;
mod rules;
mod scenario;

use computer::SimulatedComputer;
use machine::Machine;

pub use rule::{DriverRule, DriverViolation};
pub use scenario::{Act, DriverScenario, Process};

/// What a driver tells, and when: to explain a broken rule.
#[must_use]
pub fn trace_driver(scenario: &DriverScenario) -> Vec<String> {
    let machine = play(scenario);
    let machine = machine.borrow();
    machine.told.clone()
}

/// How often each rule had something to judge, and each act happened.
#[derive(Clone, Debug, Default)]
pub struct DriverCoverage {
    /// By rule.
    pub judged: BTreeMap<DriverRule, u64>,
    /// By the name of the act.
    pub acts: BTreeMap<&'static str, u64>,
}

impl AddAssign for DriverCoverage {
    fn add_assign(&mut self, other: Self) {
        for (rule, times) in other.judged {
            *self.judged.entry(rule).or_default() += times;
        }
        for (act, times) in other.acts {
            *self.acts.entry(act).or_default() += times;
        }
    }
}

/// Plays the processes of a scenario.
///
/// # Errors
/// The first broken rule.
pub fn play_driver(
    scenario: &DriverScenario,
    coverage: &mut DriverCoverage,
) -> Result<(), DriverViolation> {
    let machine = play(scenario);
    let machine = machine.borrow();
    for (rule, times) in machine.judged() {
        *coverage.judged.entry(*rule).or_default() += times;
    }
    for act in &machine.done {
        *coverage.acts.entry(act).or_default() += 1;
    }
    machine.violation.clone().map_or(Ok(()), Err)
}

fn play(scenario: &DriverScenario) -> Rc<RefCell<Machine>> {
    let machine = Rc::new(RefCell::new(Machine::new(scenario)));
    for process in &scenario.processes {
        machine.borrow_mut().starts(process);
        let mut options = Options::at(Place::Port("port".to_owned()));
        options.model = process.model;
        options.watch.clone_from(&scenario.motors);
        let computer = SimulatedComputer(Rc::clone(&machine));
        let ending = run_on(computer, &options);
        machine.borrow_mut().ended(&ending, process.pause);
    }
    machine
}

/// Leaves acts and processes out as long as the same rule is broken.
#[must_use]
pub fn shrink_driver(
    scenario: &DriverScenario,
    found: DriverViolation,
) -> (DriverScenario, DriverViolation) {
    let mut best = (scenario.clone(), found);
    // A shorter one takes its place if it breaks the same rule.
    let replaces = |best: &mut (DriverScenario, DriverViolation), shorter: DriverScenario| {
        let played = play_driver(&shorter, &mut DriverCoverage::default());
        let other = played.err().filter(|other| other.rule == best.1.rule);
        other.map(|other| *best = (shorter, other)).is_some()
    };
    for process in (0..best.0.processes.len()).rev() {
        let acts = |scenario: &DriverScenario| {
            let process = scenario.processes.get(process);
            process.map_or(0, |process| process.acts.len())
        };
        for act in (0..acts(&best.0)).rev() {
            let mut shorter = best.0.clone();
            if let Some(process) = shorter.processes.get_mut(process) {
                process.acts.remove(act);
            }
            replaces(&mut best, shorter);
        }
        let mut shorter = best.0.clone();
        shorter.processes.remove(process);
        replaces(&mut best, shorter);
    }
    best
}
