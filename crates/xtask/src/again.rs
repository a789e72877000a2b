//! Tests that failed beside others, and run once more, alone.

/// At most this many run once more. If more fail, the page is at fault.
pub const AGAIN_MAX: usize = 8;

/// The name in `test side_by_side::stopping::a_closed_tab_stops ... FAILED`. A test in a browser ends with `FAIL`.
pub fn failed_test(line: &str) -> Option<&str> {
    let rest = line.strip_prefix("test ")?;
    let name = rest.strip_suffix(" ... FAILED");
    name.or_else(|| rest.strip_suffix(" ... FAIL"))
}

/// The retry of a test, in words.
pub fn in_words(name: &str) -> String {
    format!("{name}: run alone: it failed beside others")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_failed_test_is_named() {
        assert_eq!(failed_test("test a::b ... FAILED"), Some("a::b"));
        assert_eq!(failed_test("test a::b ... FAIL"), Some("a::b"));
        assert_eq!(failed_test("test a::b ... ok"), None);
        assert_eq!(failed_test("test result: FAILED. 1 passed"), None);
    }
}
