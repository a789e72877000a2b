//! Templates with names in double braces.

use anyhow::{Result, bail};

/// Replaces each `{{name}}` with its value.
///
/// # Errors
///
/// For a name that the template does not use, and for a place without a value. Both would otherwise show
/// in the browser only.
pub fn fill(template: &str, values: &[(&str, &str)]) -> Result<String> {
    let mut filled = template.to_owned();
    for (name, value) in values {
        let place = format!("{{{{{name}}}}}");
        if !filled.contains(&place) {
            bail!("the template has no place for {place}");
        }
        filled = filled.replace(&place, value);
    }
    if let Some((_, rest)) = filled.split_once("{{") {
        let name = rest.split("}}").next().unwrap_or_default();
        bail!("nothing fills the template's {{{{{name}}}}}");
    }
    Ok(filled)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_place_is_filled() {
        let filled = fill("<a {{x}}><b {{y}}{{x}}>", &[("x", "1"), ("y", "2")]).unwrap();
        assert_eq!(filled, "<a 1><b 21>");
    }

    #[test]
    fn a_name_without_place_and_a_place_without_name_are_errors() {
        let unused = fill("<a>", &[("x", "1")]).unwrap_err();
        assert_eq!(unused.to_string(), "the template has no place for {{x}}");
        let empty = fill("<a {{z}}>", &[]).unwrap_err();
        assert_eq!(empty.to_string(), "nothing fills the template's {{z}}");
    }
}
