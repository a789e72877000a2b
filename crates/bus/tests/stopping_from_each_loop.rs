//! Stops of 2 to 16 motors from each loop, on adapters that hold received bytes.

use motorlink_bus::{Command, FIRST_BRAKE_MAX, FIRST_BRAKE_MOTORS_MAX, StopReason};
use motorlink_protocol::{Mode, family::Model};
use motorlink_simulator::{WireFaults, WorldConfig};

use crate::fixture::measured_stops::{MeasuredStop, Stopped, loops, measure};
use crate::fixture::{Fixture, id, ms};

fn of_115(mode: Mode, motors: u8, hold_ms: u64) -> Stopped {
    Stopped {
        model: Model::Ddsm115,
        mode,
        motors,
        hold: ms(hold_ms),
        switch_frames: 1,
    }
}

fn assert_all_braked(stopped: Stopped) -> MeasuredStop {
    let stop = measure(stopped);
    let last = stop.last_first_brake();
    assert!(
        last <= Some(FIRST_BRAKE_MAX) && last.is_some(),
        "{stopped:?}: {stop:?}"
    );
    let confirmed = stop.confirmed;
    // 16 motors behind an adapter that holds bytes for 16 ms: a round takes 92 ms, and the angle needs one more.
    let most = if (stopped.motors, stopped.hold) == (16, ms(16)) {
        ms(1_600)
    } else {
        ms(1_500)
    };
    assert!(
        confirmed <= Some(most) && confirmed.is_some(),
        "{stopped:?}: {stop:?}"
    );
    assert!(stop.fastest_rpm < 1.0, "{stopped:?}: {stop:?}");
    stop
}

/// Rounds longer than the time between two switches starved brakes and queries: motor 1 got one brake and 129 switches,
/// while motor 2 stood.
#[test]
fn two_motors_in_the_current_loop_on_an_adapter_that_holds_16_ms_stop_together() {
    let stop = assert_all_braked(of_115(Mode::Current, 2, 16));
    let [first, second] = *stop.first_brakes.unwrap() else {
        panic!("two motors")
    };
    assert!(second.abs_diff(first) <= ms(20), "{first:?} {second:?}");
}

#[test]
fn five_motors_in_the_current_loop_on_a_good_line_are_braked_and_stand() {
    assert_all_braked(of_115(Mode::Current, 5, 0));
}

#[test]
fn eight_motors_are_braked_within_150_ms_from_each_loop_on_each_adapter() {
    for model in Model::ALL {
        for mode in loops(model) {
            // The bus asks for the loop of a motor with separate frames before it drives it, so that not more of them can be
            // driven.
            let most = if model.has_separate_frames() { 1 } else { 16 };
            for hold in [1, 4, 8, 16]
                .into_iter()
                .filter(|hold| *hold <= most)
                .map(ms)
            {
                let stopped = Stopped {
                    model,
                    mode,
                    hold,
                    ..of_115(mode, 8, 0)
                };
                let stop = assert_all_braked(stopped);
                // A frame of a DDSM400 takes three times as long.
                let most = ms(if model == Model::Ddsm400 { 160 } else { 150 });
                let last = stop.last_first_brake();
                assert!(last <= Some(most), "{stopped:?}: {stop:?}");
            }
        }
    }
}

#[test]
fn up_to_16_motors_are_braked_within_the_bound_from_each_loop() {
    for mode in loops(Model::Ddsm115) {
        for motors in [3, 12, FIRST_BRAKE_MOTORS_MAX] {
            for hold_ms in [1, 16] {
                assert_all_braked(of_115(mode, motors, hold_ms));
            }
        }
    }
}

#[test]
fn sixteen_motors_of_each_model_are_braked_within_the_bound() {
    for model in Model::ALL {
        for mode in loops(model) {
            for hold in [0, 1].map(ms) {
                let stopped = of_115(mode, FIRST_BRAKE_MOTORS_MAX, 0);
                assert_all_braked(Stopped {
                    model,
                    hold,
                    ..stopped
                });
            }
        }
    }
}

/// A motor may need as many mode switches as the maker's samples send.
#[test]
fn motors_that_need_five_switches_are_braked_and_stand() {
    for mode in [Mode::Current, Mode::Position] {
        for (motors, hold) in [(1, 16), (2, 16), (8, 1), (8, 16), (16, 16)] {
            let stopped = Stopped {
                switch_frames: 5,
                ..of_115(mode, motors, hold)
            };
            let stop = measure(stopped);
            assert!(stop.confirmed.is_some(), "{stopped:?}: {stop:?}");
            assert!(
                stop.last_first_brake() <= Some(ms(1_500)),
                "{stopped:?}: {stop:?}"
            );
        }
    }
}

/// The wheels stand at 100 degrees and are sent to 280. A brake frame in that loop would send them to 0.
#[test]
fn no_wheel_in_the_position_loop_turns_back_to_0_degrees() {
    for hold in [1, 16] {
        for motors in [2, 8, 16] {
            let stop = assert_all_braked(of_115(Mode::Position, motors, hold));
            assert!(stop.turned_back_deg < 1.0, "{hold} ms, {motors}: {stop:?}");
        }
    }
}

/// The adapter holds replies that report the velocity loop, from before the switch to the position loop. A brake frame
/// for them would turn the wheel to 0 degrees.
#[test]
fn a_held_reply_from_before_the_stop_is_not_taken_for_the_loop_after_it() {
    let ids = [id(1), id(2)];
    for hold in [16, 60, 120].map(ms) {
        for delay in (0..160).step_by(10).map(ms) {
            let mut config = WorldConfig::with_ids(ids);
            for motor in &mut config.motors {
                motor.angle_deg = 120.0;
            }
            let mut fixture = Fixture::watching(config, &ids);
            fixture.world.set_faults(WireFaults {
                hold,
                ..WireFaults::default()
            });
            fixture.run(ms(50));
            let mode = Mode::Position;
            for id in ids {
                fixture.command(Command::SwitchMode { id, mode }).unwrap();
            }
            fixture.run(delay);
            fixture
                .command(Command::StopAll(StopReason::Operator))
                .unwrap();
            for id in ids {
                fixture.command(Command::Stop(id)).unwrap();
            }
            fixture.run(ms(4_000));
            for id in ids {
                let angle = fixture.world.motor(id).unwrap().angle_deg();
                let turned = (angle - 120.0).abs();
                assert!(turned < 2.0, "{hold:?}, after {delay:?}: {angle}");
            }
        }
    }
}
