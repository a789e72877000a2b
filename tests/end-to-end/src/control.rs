//! One control or read-out of the page, as a screen reader sees it.

use std::cell::OnceCell;

use anyhow::{Context, Result, bail, ensure};
use serde_json::{Value, json};

use crate::cdp::{Session, at};
use crate::keyboard::Key;

/// A node of the accessibility tree. It becomes invalid when the page replaces its element: find it again for every
/// use.
pub struct Control {
    pub(crate) session: Session,
    /// The node's id in the `DevTools` protocol.
    pub(crate) node: i64,
    /// Its JavaScript object, set on first use.
    object: OnceCell<String>,
    /// Its role, in the browser's terms.
    pub role: String,
    /// Its accessible name.
    pub name: String,
    /// Its accessible description: what a title or `aria-describedby` says.
    pub description: String,
    /// Whether it is disabled.
    pub disabled: bool,
    /// The value of a field, slider or combobox; otherwise empty.
    pub value: String,
    /// Whether it is checked, pressed or selected.
    pub on: bool,
}

impl Control {
    /// Parses a node of the accessibility tree; `None` if it is ignored, for example hidden.
    pub(crate) fn read(session: &Session, node: &Value) -> Option<Self> {
        if at(node, "/ignored").as_bool() != Some(false) {
            return None;
        }
        let text = |pointer: &str| match at(node, pointer) {
            Value::String(text) => text.clone(),
            Value::Null => String::new(),
            other => other.to_string(),
        };
        let properties = at(node, "/properties")
            .as_array()
            .map(Vec::as_slice)
            .unwrap_or_default();
        let is = |name: &str| {
            properties.iter().any(|property| {
                let value = at(property, "/value/value");
                at(property, "/name") == name && (*value == json!(true) || *value == json!("true"))
            })
        };
        Some(Self {
            session: session.clone(),
            node: at(node, "/backendDOMNodeId").as_i64()?,
            object: OnceCell::new(),
            role: text("/role/value"),
            name: text("/name/value"),
            description: text("/description/value"),
            value: text("/value/value"),
            disabled: is("disabled"),
            on: is("checked") || is("pressed") || is("selected"),
        })
    }

    /// The text in it.
    ///
    /// # Errors
    ///
    /// When it has left the page.
    pub fn text(&self) -> Result<String> {
        let text = self.ask("function () { return this.textContent; }", &[])?;
        Ok(text
            .as_str()
            .unwrap_or_default()
            .split_whitespace()
            .collect::<Vec<_>>()
            .join(" "))
    }

    /// Focuses it.
    ///
    /// # Errors
    ///
    /// When it cannot be focused.
    pub fn focus(&self) -> Result<()> {
        self.session
            .call("DOM.focus", json!({ "backendNodeId": self.node }))?;
        Ok(())
    }

    /// Replaces the content of a text field or spinbutton by typing, and confirms with Enter.
    ///
    /// # Errors
    ///
    /// When it is disabled, or no key types a character of `text`.
    pub fn fill(&self, text: &str) -> Result<()> {
        self.type_over(text)?;
        press(&self.session, &Key::named("Enter")?)
    }

    /// Replaces the content of a text field or spinbutton by typing.
    ///
    /// # Errors
    ///
    /// When it is disabled, or no key types a character of `text`.
    pub fn type_over(&self, text: &str) -> Result<()> {
        ensure!(
            !self.disabled,
            "{} is disabled: {}",
            self.title(),
            self.description
        );
        self.focus()?;
        self.ask("function () { this.select(); }", &[])?;
        press(&self.session, &Key::named("Delete")?)?;
        for character in text.chars() {
            press(&self.session, &Key::named(&character.to_string())?)?;
        }
        Ok(())
    }

    /// Moves a slider to a value, with the events at the end of a drag. A mouse cannot hit every value of a wide
    /// range; for real key presses use [`crate::Page::press`] after [`Control::focus`].
    ///
    /// # Errors
    ///
    /// When it is disabled.
    pub fn slide(&self, value: f64) -> Result<()> {
        ensure!(
            !self.disabled,
            "{} is disabled: {}",
            self.title(),
            self.description
        );
        let function = "function (value) {
            this.value = value;
            this.dispatchEvent(new Event('input', { bubbles: true }));
            this.dispatchEvent(new Event('change', { bubbles: true }));
        }";
        self.ask(function, &[json!(value)]).map(drop)
    }

    /// Chooses an option of a combobox by its text.
    ///
    /// # Errors
    ///
    /// When it is disabled or has no such option: the error lists its options.
    pub fn choose(&self, option: &str) -> Result<()> {
        ensure!(
            !self.disabled,
            "{} is disabled: {}",
            self.title(),
            self.description
        );
        // A user focuses it first, and a list may be filled only then.
        self.ask("function () { this.focus(); return null; }", &[])?;
        let function = "function (wanted) {
            const words = (option) => option.textContent.trim().replace(/\\s+/g, ' ');
            const option = [...this.options].find((option) => words(option) === wanted);
            if (!option) return [...this.options].map(words);
            this.value = option.value;
            this.dispatchEvent(new Event('input', { bubbles: true }));
            this.dispatchEvent(new Event('change', { bubbles: true }));
            return null;
        }";
        match self.ask(function, &[json!(option)])? {
            Value::Null => Ok(()),
            options => bail!("{} has no option {option:?}, only {options}", self.title()),
        }
    }

    /// Its role and name, for messages.
    #[must_use]
    pub fn title(&self) -> String {
        format!("{} {:?}", self.role, self.name)
    }

    /// The value of a JavaScript function that is called with its element as `this`.
    ///
    /// # Errors
    ///
    /// When it throws, or the element has left the page.
    pub fn ask(&self, function: &str, arguments: &[Value]) -> Result<Value> {
        let answer = || {
            let object = match self.object.get() {
                Some(object) => object.clone(),
                None => self.session.object_of(self.node)?,
            };
            let object = self.object.get_or_init(|| object);
            self.session.call_on(object, function, arguments)
        };
        answer().with_context(|| format!("at {}", self.title()))
    }
}

/// Presses and releases a key.
pub(crate) fn press(session: &Session, key: &Key) -> Result<()> {
    session.call("Input.dispatchKeyEvent", key.down())?;
    session.call("Input.dispatchKeyEvent", key.up())?;
    Ok(())
}
