//! Scenarios of the list `Packets`.

use super::*;

/// Ten rows high, wide enough for rows of one line.
const HEIGHT_PX: u32 = 240;

fn list(oldest: u64, end: u64) -> LogView {
    let mut view = LogView::default();
    view.resize(600, HEIGHT_PX);
    view.set_rows(oldest, end);
    settle(&mut view);
    view
}

/// The page sets height and scroll bar from the view, and the browser reports the position.
fn settle(view: &mut LogView) {
    if let Some(extent_px) = view.extent_to() {
        view.extends_over(extent_px);
    }
    if let Some(scroll_px) = view.scroll_to() {
        view.stands_at(scroll_px);
        view.scrolled(scroll_px);
    }
}

/// The user moves the scroll bar.
fn scroll_by(view: &mut LogView, px: i32) {
    let end = i32::try_from(view.range_px()).unwrap();
    view.scrolled((view.scroll_px + px).clamp(0, end));
}

fn seen(view: &LogView) -> (u64, u64, u64) {
    (view.first_row(), view.hidden_px(), view.row_behind())
}

#[test]
fn the_newest_rows_are_seen_and_stay_seen() {
    let mut view = list(0, 100);
    assert_eq!(seen(&view), (90, 0, 100));
    view.set_rows(0, 103);
    settle(&mut view);
    assert!(view.is_following());
    assert_eq!(seen(&view), (93, 0, 103));
    assert_eq!(view.scroll_px, 103 * 24 - 240);
}

#[test]
fn a_short_log_begins_at_the_top() {
    let view = list(5, 8);
    assert_eq!(seen(&view), (5, 0, 8));
    assert_eq!(view.extent_px, 72);
    assert_eq!(view.scroll_to(), None);
}

#[test]
fn scrolling_up_lets_go_and_what_is_read_stays() {
    let mut view = list(0, 100);
    scroll_by(&mut view, -50);
    assert!(!view.is_following());
    assert_eq!(seen(&view), (87, 22, 98));
    view.set_rows(0, 140);
    settle(&mut view);
    assert_eq!(seen(&view), (87, 22, 98));
    assert_eq!(view.new_rows(), 40);
}

#[test]
fn what_is_read_stays_while_old_rows_give_way_above_it() {
    let mut view = list(0, 1_000);
    scroll_by(&mut view, -12_000);
    let before = seen(&view);
    assert_eq!(before, (490, 0, 500));
    for gone in [1, 50, 490] {
        view.set_rows(gone, 1_000 + gone);
        settle(&mut view);
        assert_eq!(seen(&view), before, "{gone}");
    }
    assert_eq!(view.scroll_px, 0);
    // There is nothing above it any more: it goes with the oldest.
    view.set_rows(600, 1_600);
    assert_eq!(seen(&view), (600, 0, 610));
}

#[test]
fn the_way_back_is_the_end_of_the_scroll_bar_the_button_or_the_checkbox() {
    let read = || {
        let mut view = list(0, 100);
        scroll_by(&mut view, -500);
        view.set_rows(0, 120);
        settle(&mut view);
        assert!(!view.is_following());
        view
    };
    let mut view = read();
    scroll_by(&mut view, 400);
    assert!(!view.is_following(), "not there yet");
    scroll_by(&mut view, 100_000);
    assert!(view.is_following());

    let mut view = read();
    view.follow();
    assert_eq!((view.new_rows(), view.first_row()), (0, 110));
}

#[test]
fn what_we_do_to_the_scroll_bar_is_not_a_persons_doing() {
    let mut view = list(0, 100);
    // Rows went when the log was filtered; the browser moved the scroll bar to the new end.
    view.set_rows(0, 30);
    view.extends_over(660);
    view.stands_at(440);
    view.scrolled(440);
    assert!(view.is_following());
    // A screen of odd pixels rounds.
    view.scrolled(439);
    assert!(view.is_following());
    view.scrolled(437);
    assert!(!view.is_following());
}

#[test]
fn a_scroll_bar_in_hand_is_left_alone_and_its_end_is_the_newest_row_all_the_same() {
    let mut view = list(0, 100);
    scroll_by(&mut view, -500);
    // Ten screens come while a key has the list scroll to what was its end.
    view.set_rows(0, 200);
    scroll_by(&mut view, 300);
    assert_eq!(seen(&view), (81, 16, 92));
    view.scrolled(100 * 24 - 240);
    assert!(view.is_following());
    settle(&mut view);
    assert_eq!(seen(&view), (190, 0, 200));
}

#[test]
fn a_million_rows_have_a_scroll_bar_that_a_browser_can_hold() {
    let mut view = list(0, 1_000_000);
    assert_eq!(view.extent_px, 8_000_000);
    assert_eq!(seen(&view), (999_990, 0, 1_000_000));
    // A turn of the mouse wheel moves by as many pixels as ever.
    scroll_by(&mut view, -100);
    assert_eq!(seen(&view), (999_985, 20, 999_996));
    // Dragged to the middle.
    view.scrolled(3_999_880);
    assert_eq!(seen(&view), (499_995, 0, 500_005));
    view.scrolled(0);
    assert_eq!(seen(&view), (0, 0, 10));
    scroll_by(&mut view, 100);
    assert_eq!(seen(&view), (4, 4, 15));
    view.scrolled(7_999_760);
    assert!(view.is_following());
}

#[test]
fn on_a_full_log_the_scroll_bar_goes_up_with_what_is_read() {
    let mut view = list(0, 1_000_000);
    view.scrolled(3_999_880);
    let before = seen(&view);
    view.set_rows(250_000, 1_250_000);
    assert_eq!(view.scroll_to(), Some(1_999_920));
    settle(&mut view);
    assert_eq!(seen(&view), before);
    assert_eq!(view.new_rows(), 250_000);
}

#[test]
fn a_narrow_list_has_rows_of_two_lines_and_keeps_its_first_row() {
    let mut view = list(0, 100);
    scroll_by(&mut view, -50 * 24);
    assert_eq!(view.first_row(), 40);
    view.resize(350, HEIGHT_PX);
    assert!(view.has_two_lines());
    assert_eq!(seen(&view), (40, 0, 46));
    assert_eq!(view.extent_to(), Some(4_400));
}

#[test]
fn what_is_asked_for_is_more_than_what_is_seen_and_not_asked_for_twice() {
    let mut view = list(0, 1_000);
    let newest = view.window_to_request(None).unwrap();
    assert_eq!(
        newest,
        Window {
            first: None,
            rows: 24
        }
    );
    view.set_rows(0, 1_100);
    settle(&mut view);
    assert_eq!(view.window_to_request(Some(newest)), None);

    scroll_by(&mut view, -2_400);
    let there = view.window_to_request(Some(newest)).unwrap();
    assert_eq!((there.first, there.rows), (Some(978), 36));
    scroll_by(&mut view, -100);
    assert_eq!(
        view.window_to_request(Some(there)),
        None,
        "it is within what was asked for"
    );
    scroll_by(&mut view, -100);
    assert!(view.window_to_request(Some(there)).is_some());
}

#[test]
fn near_the_ends_of_the_log_nothing_is_asked_for_over_and_over() {
    let mut view = list(300, 1_000);
    view.scrolled(0);
    let window = view.window_to_request(None).unwrap();
    assert_eq!(window.first, Some(300));
    assert_eq!(view.window_to_request(Some(window)), None);
    scroll_by(&mut view, 15_000);
    let window = view.window_to_request(Some(window)).unwrap();
    view.set_rows(301, 1_001);
    assert_eq!(view.window_to_request(Some(window)), None);
}

#[test]
fn a_list_without_a_height_asks_for_a_few_rows_and_no_list_for_too_many() {
    let mut view = LogView::default();
    let rows = |view: &LogView| view.window_to_request(None).unwrap().rows;
    assert_eq!(rows(&view), 16);
    view.resize(600, 100_000);
    assert_eq!(rows(&view), Window::ROWS_MAX);
}
