//! One dialog for every question: only one is asked at a time.

use leptos::{html::Div, prelude::*};
use motorlink_i18n::tr;

use crate::{
    app::{
        features::Features,
        questions::{Question, question},
    },
    ui::{
        button::PressButton,
        focus::focus_when,
        reactive::{dynamic, memo},
    },
};

#[component]
pub(crate) fn QuestionDialog(features: Features) -> impl IntoView {
    let page = features.page;
    let dialog = NodeRef::<Div>::new();
    let asked = memo(move || page.dialog.get().and_then(question));
    let open = memo(move || asked.with(Option::is_some));
    focus_when(open, dialog);
    let of_question = move |read: fn(&Question) -> String| {
        dynamic(move || asked.with(|asked| asked.as_ref().map(read).unwrap_or_default()))
    };
    let yes = move || {
        let yes = asked.with(|asked| asked.as_ref().map(|question| question.yes.clone()));
        yes.unwrap_or_default()
    };
    view! {
        <div class="scrim" hidden=dynamic(move || !open.get())>
            <div
                class="dialog consent"
                role="alertdialog"
                aria-modal="true"
                aria-label=of_question(|question| question.name.to_owned())
                aria-describedby="question-words"
                tabindex="-1"
                node_ref=dialog
            >
                <h2>{of_question(|question| question.title.clone())}</h2>
                <p id="question-words">{of_question(|question| question.words.clone())}</p>
                <div class="dialog-foot">
                    <PressButton label=tr!("Cancel") on_press=move || page.decline() />
                    <PressButton
                        label=Signal::derive(yes)
                        class="button primary"
                        on_press=move || features.agree()
                    />
                </div>
            </div>
        </div>
    }
}
