//! Random tables and random texts: what is written is read, and nothing panics.

use motorlink_experiments::{
    plan::{Fleet, Plan},
    sequence::{
        Action, Condition, End, Move, Quantity, Repeat, RunLimits, Selection, Sequence, Shape,
        Step, Wave, from_csv,
    },
};
use motorlink_protocol::{Acceleration, MotorId};
use proptest::prelude::*;

fn id(address: u8) -> MotorId {
    MotorId::new(address).unwrap()
}

fn fleet() -> Fleet {
    Fleet::of([id(1), id(2)])
}

fn any_number() -> impl Strategy<Value = f64> {
    (-4_000_i32..4_000).prop_map(|tenths| f64::from(tenths) / 10.0)
}

fn any_move() -> impl Strategy<Value = Step> {
    let selection = prop_oneof![
        Just(Selection::All),
        (1_u8..=254).prop_map(|address| Selection::Motor(id(address))),
        "[a-z\"\\\\ü]{1,8}".prop_map(Selection::Group),
    ];
    let shape = (0..5, any_number(), any_number(), any_number(), any_number()).prop_map(
        |(kind, to, amplitude, hz, to_hz)| {
            let wave = Wave {
                centre: to,
                amplitude,
                hz,
            };
            match kind {
                0 => Shape::Step { to },
                1 => Shape::Ramp { to },
                2 => Shape::Sine(wave),
                3 => Shape::Triangle(wave),
                _ => Shape::Chirp { wave, to_hz },
            }
        },
    );
    let condition =
        (0..5, any_number(), any_number()).prop_map(|(kind, value, tolerance)| match kind {
            0 => Condition::RpmAbove(value),
            1 => Condition::RpmBelow(value),
            2 => Condition::CelsiusAbove(value),
            3 => Condition::CelsiusBelow(value),
            _ => Condition::DegreesNear {
                degrees: value,
                tolerance,
            },
        });
    let end = (any::<bool>(), any_number(), condition).prop_map(|(after, seconds, condition)| {
        if after {
            End::After(seconds)
        } else {
            End::Until {
                condition,
                within_s: seconds,
            }
        }
    });
    (selection, 0..4_usize, shape, any::<u8>(), end).prop_map(
        |(selection, quantity, shape, acceleration, end)| {
            let action = match Quantity::ALL.get(quantity) {
                None => Action::Brake,
                Some(quantity) => Action::Follow {
                    quantity: *quantity,
                    shape,
                    acceleration: if *quantity == Quantity::Rpm {
                        Acceleration::new(acceleration)
                    } else {
                        Acceleration::DEFAULT
                    },
                },
            };
            Step::Move(Move {
                selection,
                action,
                end,
            })
        },
    )
}

proptest! {
    /// Whatever a table holds is read back from its file, and neither reading nor checking panics.
    #[test]
    fn a_file_holds_what_the_table_held(
        steps in prop::collection::vec(any_move(), 1..6),
        passes in any::<u32>(),
        rpm in prop::option::of(any_number()),
    ) {
        let inner = Step::Repeat(Repeat { passes, until: None, steps: steps.clone() });
        let sequence = Sequence {
            name: "any".to_owned(),
            limits: RunLimits { rpm, ..RunLimits::default() },
            steps: [steps, vec![inner]].concat(),
        };
        let back = Sequence::from_json(&sequence.to_json());
        prop_assert_eq!(back.as_ref(), Ok(&sequence));
        if let Ok(plan) = Plan::new(&sequence, &fleet()) {
            prop_assert!(plan.curves().iter().all(|curve| !curve.points.is_empty()));
        }
    }

    /// No text makes the readers panic.
    #[test]
    fn any_text_is_read_or_refused(text in "[\\PC\n]{0,200}") {
        let _ = Sequence::from_json(&text);
        let _ = from_csv(&text, &[]);
    }
}
