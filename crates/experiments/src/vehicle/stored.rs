//! A vehicle with its measures as JSON, for a session file.

use motorlink_protocol::MotorId;
use nojson::{RawJson, RawJsonValue};

use super::{Geometry, Vehicle, Wheel};

impl Vehicle {
    /// `wheel_radius_mm`, `track_width_mm`, and of each wheel in `wheels` its motor (`id`), its `side`, and the sign of the
    /// motor's own speed that drives forward (`forward_sign`). The names of the motors are not in it.
    #[must_use]
    pub fn to_json(&self, geometry: Geometry) -> String {
        let json = nojson::object(|f| {
            f.member("wheel_radius_mm", geometry.radius_mm)?;
            f.member("track_width_mm", geometry.track_mm)?;
            let wheels = nojson::array(|f| {
                for wheel in &self.wheels {
                    f.element(nojson::object(|f| {
                        f.member("id", wheel.id.get())?;
                        f.member("side", if wheel.is_right { "right" } else { "left" })?;
                        f.member("forward_sign", if wheel.is_right { -1 } else { 1 })
                    }))?;
                }
                Ok(())
            });
            f.member("wheels", wheels)
        });
        json.to_string()
    }

    /// Reads what [`to_json`](Self::to_json) writes; `None` for anything else.
    #[must_use]
    pub fn from_json(text: &str) -> Option<(Self, Geometry)> {
        let json = RawJson::parse(text).ok()?;
        let of = json.value();
        let geometry = Geometry::new(
            integer(of, "wheel_radius_mm")?,
            integer(of, "track_width_mm")?,
        )?;
        let wheels = of.to_member("wheels").ok()?.optional()?;
        let wheel = |wheel: RawJsonValue<'_, '_>| {
            let side = wheel.to_member("side").ok()?.optional()?;
            Some(Wheel {
                id: MotorId::new(integer(wheel, "id")?.try_into().ok()?).ok()?,
                is_right: match side.as_raw_str() {
                    "\"left\"" => false,
                    "\"right\"" => true,
                    _ => return None,
                },
                name: String::new(),
            })
        };
        let wheels: Option<Vec<_>> = wheels.to_array().ok()?.map(wheel).collect();
        Some((Self::new(wheels?)?, geometry))
    }
}

fn integer(object: RawJsonValue<'_, '_>, name: &str) -> Option<i32> {
    let member = object.to_member(name).ok()?.optional()?;
    member.as_integer_str().ok()?.parse().ok()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_vehicle_is_read_as_it_was_written() {
        let wheel = |id, is_right| Wheel {
            id: MotorId::new(id).unwrap(),
            is_right,
            name: String::new(),
        };
        let vehicle = Vehicle::new(vec![wheel(3, false), wheel(4, true)]).unwrap();
        let geometry = Geometry::new(60, 420).unwrap();
        let text = vehicle.to_json(geometry);
        assert_eq!(
            text,
            r#"{"wheel_radius_mm":60,"track_width_mm":420,"wheels":[{"id":3,"side":"left","forward_sign":1},{"id":4,"side":"right","forward_sign":-1}]}"#
        );
        assert_eq!(Vehicle::from_json(&text), Some((vehicle, geometry)));
        for (from, to) in [
            ("420", "42000"),
            ("right", "left"),
            ("right", "up"),
            ("4,", "255,"),
        ] {
            assert_eq!(
                Vehicle::from_json(&text.replace(from, to)),
                None,
                "{from} {to}"
            );
        }
    }
}
