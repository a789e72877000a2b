//! The address of the page.

use motorlink_messages::{VirtualLine, VirtualMotors, protocol::family::Model};

/// A query parameter, such as `virtual` of `?port=virtual`.
pub(crate) fn parameter(name: &str) -> Option<String> {
    let query = web_sys::window()?.location().search().ok()?;
    web_sys::UrlSearchParams::new_with_str(&query)
        .ok()?
        .get(name)
}

/// Bytes of a value that are shown. No valid value is longer.
const SHOWN_MAX: usize = 20;

/// A parameter with a value that it cannot have.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) struct BadParameter {
    /// `motors=99`
    pub(crate) text: String,
    /// The values that it can have.
    pub(crate) possible: &'static str,
}

/// The virtual line that `?port=virtual&motors=4&model=ddsm400` asks for. Without the last two it is one DDSM115,
/// whatever was connected last: an address means the same in every browser.
pub(crate) fn virtual_line(
    parameter: impl Fn(&str) -> Option<String>,
) -> Option<Result<VirtualLine, BadParameter>> {
    (parameter("port")? == "virtual").then(|| {
        let VirtualLine { motors, model } = VirtualLine::DEFAULT;
        let bad = |name, value: String, possible| {
            let shown = value.get(..SHOWN_MAX).unwrap_or(&value);
            BadParameter {
                text: format!("{name}={shown}"),
                possible,
            }
        };
        Ok(VirtualLine {
            motors: match parameter("motors") {
                Some(value) => VirtualMotors::from_key(&value)
                    .ok_or_else(|| bad("motors", value, "1, 2, 4, 8, faults"))?,
                None => motors,
            },
            model: match parameter("model") {
                Some(value) => Model::ALL
                    .into_iter()
                    .find(|model| model.spec().key == value)
                    .ok_or_else(|| bad("model", value, "ddsm115, ddsm315, ddsm210, ddsm400"))?,
                None => model,
            },
        })
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn of(address: &str) -> Option<Result<VirtualLine, BadParameter>> {
        let parameters: Vec<_> = address
            .split('&')
            .filter_map(|it| it.split_once('='))
            .collect();
        virtual_line(|name| {
            let found = parameters.iter().find(|(other, _)| *other == name);
            found.map(|(_, value)| (*value).to_owned())
        })
    }

    #[test]
    fn an_address_asks_for_virtual_motors() {
        assert_eq!(of("port=virtual"), Some(Ok(VirtualLine::DEFAULT)));
        let rover = VirtualLine {
            motors: VirtualMotors::Four,
            model: Model::Ddsm400,
        };
        assert_eq!(of("port=virtual&motors=4&model=ddsm400"), Some(Ok(rover)));
        assert_eq!(of("model=ddsm400&motors=4&port=virtual"), Some(Ok(rover)));
        for other in ["", "motors=4", "port=serial&motors=99"] {
            assert_eq!(of(other), None, "{other}");
        }
    }

    #[test]
    fn a_bad_value_names_the_possible_ones() {
        let bad = |address| of(address).unwrap().unwrap_err();
        let motors = bad("port=virtual&motors=99&model=ddsm400");
        assert_eq!(motors.text, "motors=99");
        let keys = VirtualMotors::ALL.map(VirtualMotors::key).join(", ");
        assert_eq!(motors.possible, keys);
        let model = bad("port=virtual&model=foo");
        assert_eq!(model.text, "model=foo");
        assert_eq!(
            model.possible,
            Model::ALL.map(|it| it.spec().key).join(", ")
        );
        let long = bad(&format!("port=virtual&model={}", "x".repeat(1_000)));
        assert_eq!(long.text.len(), "model=".len() + SHOWN_MAX);
    }
}
