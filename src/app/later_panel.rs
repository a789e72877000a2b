//! A panel of the drawer whose part of the program is loaded when the panel is opened first: few people need it.

use std::pin::Pin;

use leptos::{html::Div, prelude::*, task::spawn_local, wasm_split::SplitLoaderError};

use crate::{
    app::{
        absent::{Absent, notice},
        features::Features,
        mount::{Hosts, Mounted},
    },
    ui::{
        drawer::{Drawer, panel_of_drawer},
        reactive::effect,
    },
};

/// Loads a part, and mounts this panel of it.
pub(crate) type Load =
    fn(
        Hosts,
        Features,
        Drawer,
    ) -> Pin<Box<dyn Future<Output = Result<Vec<Option<Mounted>>, SplitLoaderError>>>>;

/// The panel. `owner` is the owner of the page.
pub(crate) fn later_panel(
    which: Drawer,
    title: &'static str,
    features: Features,
    owner: StoredValue<WeakOwner>,
    load: Load,
) -> impl IntoView {
    let page = features.page;
    let place = NodeRef::<Div>::new();
    let mounted: StoredValue<Vec<Option<Mounted>>, LocalStorage> =
        StoredValue::new_local(Vec::new());
    let state = RwSignal::new(Absent::Loading);
    let load = move || {
        let element = place.get_untracked();
        let owner = owner.get_value().upgrade();
        let (Some(element), Some(owner)) = (element, owner) else {
            return;
        };
        state.set(Absent::Loading);
        spawn_local(async move {
            let elements = vec![element.into()];
            match load(Hosts { owner, elements }, features, which).await {
                // In another language meanwhile, they are dropped.
                Ok(sections) => drop(mounted.try_set_value(sections)),
                Err(_) => drop(state.try_set(Absent::Missing)),
            }
        });
    };
    effect(move || {
        let is_open = page.drawer.get() == Some(which);
        if is_open && mounted.with_value(Vec::is_empty) {
            load();
        }
    });
    panel_of_drawer(
        page.drawer,
        which,
        title,
        view! { <div node_ref=place>{notice(state, load)}</div> },
    )
}
