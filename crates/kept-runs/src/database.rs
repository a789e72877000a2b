//! The database of the browser (IndexedDB): a store of headers, and one of the parts of the records.
//!
//! Everything is in the encoding of the messages between page and workers. What another version of the page has
//! written and this one cannot read is skipped.

use js_sys::{Array, Promise, Reflect, Uint8Array};
use motorlink_messages::{
    decode, encode,
    experiments::{
        kept::RunHeader,
        runner::{Record, RecordPart},
    },
};
use wasm_bindgen::{JsCast, JsValue, prelude::Closure};
use wasm_bindgen_futures::JsFuture;
use web_sys::{
    IdbDatabase, IdbFactory, IdbKeyRange, IdbObjectStore, IdbOpenDbRequest, IdbRequest,
    IdbTransactionMode,
};

const NAME: &str = "motorlink-experiments";
const VERSION: u32 = 1;
const RUNS: &str = "runs";
const PARTS: &str = "parts";
/// The key of a part is the number of its run times this, plus its place. A day has fewer seconds.
const PARTS_MAX: f64 = 1_000_000.0;

type Result<T> = std::result::Result<T, JsValue>;

/// The database, while it is open.
#[derive(Debug)]
pub struct Database {
    database: IdbDatabase,
    _on_erased: Closure<dyn FnMut()>,
}

impl Database {
    /// Opens it, and creates it at the first visit. Calls `on_erased` when the user deletes all data, also in another
    /// tab.
    ///
    /// # Errors
    /// The browser has no database for this site, such as in a private window.
    pub async fn open(on_erased: impl Fn() + 'static) -> Result<Self> {
        let request: IdbOpenDbRequest = factory()?.open_with_u32(NAME, VERSION)?;
        let opened = request.clone();
        let create = Closure::once(move || {
            let stores = opened.result().map(JsCast::unchecked_into::<IdbDatabase>);
            if let Ok(database) = stores {
                // If it fails, the opening fails too.
                let _ = database.create_object_store(RUNS);
                let _ = database.create_object_store(PARTS);
            }
        });
        request.set_onupgradeneeded(Some(create.as_ref().unchecked_ref()));
        let database: IdbDatabase = done(&request).await?.unchecked_into();
        let open = database.clone();
        // The browser deletes it when it is closed everywhere.
        let on_erased = Closure::<dyn FnMut()>::new(move || {
            open.close();
            on_erased();
        });
        database.set_onversionchange(Some(on_erased.as_ref().unchecked_ref()));
        Ok(Self {
            database,
            _on_erased: on_erased,
        })
    }

    /// All headers.
    ///
    /// # Errors
    /// The browser cannot read them.
    pub async fn headers(&self) -> Result<Headers> {
        let all = done(&self.store(RUNS, false)?.get_all()?).await?;
        let read = read_all(&all);
        let unread = (Array::from(&all).length() as usize).saturating_sub(read.len());
        Ok(Headers { read, unread })
    }

    /// Stores a header, in place of an older one of the same run.
    ///
    /// # Errors
    /// The browser cannot store it, such as on a full disk.
    pub async fn put_header(&self, header: &RunHeader) -> Result<()> {
        let bytes = bytes_of(header)?;
        let store = self.store(RUNS, true)?;
        store.put_with_key(&bytes, &header.number.into())?;
        stored(&store).await
    }

    /// Stores a part of a record: an encoded [`RecordPart`].
    ///
    /// # Errors
    /// The browser cannot store it, such as on a full disk.
    pub async fn add_part(&self, run: u32, place: u32, part: &[u8]) -> Result<()> {
        let key = f64::from(run) * PARTS_MAX + f64::from(place);
        let store = self.store(PARTS, true)?;
        store.put_with_key(&Uint8Array::from(part), &key.into())?;
        stored(&store).await
    }

    /// Stores a whole run, in place of what there is of a run with its number. `part` is its encoded [`RecordPart`]. Nothing
    /// is changed if it fails.
    ///
    /// # Errors
    /// The browser cannot store it, such as on a full disk.
    pub async fn put_run(&self, header: &RunHeader, part: &[u8]) -> Result<()> {
        let header_bytes = bytes_of(header)?;
        let [runs, parts] = self.both()?;
        parts.delete(&range(header.number)?)?;
        let key = f64::from(header.number) * PARTS_MAX;
        parts.put_with_key(&Uint8Array::from(part), &key.into())?;
        runs.put_with_key(&header_bytes, &header.number.into())?;
        stored(&runs).await
    }

    /// The numbers of all runs, also of those that this version cannot read.
    ///
    /// # Errors
    /// The browser cannot read them.
    #[allow(
        clippy::cast_possible_truncation,
        clippy::cast_sign_loss,
        reason = "each key is a number of a run"
    )]
    pub async fn numbers(&self) -> Result<Vec<u32>> {
        let all = done(&self.store(RUNS, false)?.get_all_keys()?).await?;
        let number = |key: JsValue| key.as_f64().map(|key| key as u32);
        Ok(Array::from(&all).iter().filter_map(number).collect())
    }

    /// The record of a run, and whether it has every part: see [`RunHeader::lacks_data`].
    ///
    /// # Errors
    /// The browser or this version cannot read all that is stored.
    pub async fn record(&self, run: &RunHeader) -> Result<(Record, bool)> {
        let store = self.store(PARTS, false)?;
        let all = done(&store.get_all_with_key(&range(run.number)?)?).await?;
        let parts: Vec<RecordPart> = read_all(&all);
        let all = Array::from(&all);
        if parts.len() < all.length() as usize {
            return Err("a part of another version".into());
        }
        let sizes = all.iter().filter_map(|part| part.dyn_into().ok());
        let stored: u64 = sizes.map(|part: Uint8Array| u64::from(part.length())).sum();
        let mut record = run.record();
        for part in parts {
            record.add_part(part);
        }
        Ok((record, !run.lacks_data(stored)))
    }

    /// Deletes a run.
    ///
    /// # Errors
    /// The browser cannot delete it.
    pub async fn delete(&self, run: u32) -> Result<()> {
        let [runs, parts] = self.both()?;
        runs.delete(&run.into())?;
        parts.delete(&range(run)?)?;
        stored(&runs).await
    }

    /// Both stores, in one transaction that writes.
    fn both(&self) -> Result<[IdbObjectStore; 2]> {
        let names: Array = [RUNS, PARTS].into_iter().map(JsValue::from).collect();
        let transaction = self
            .database
            .transaction_with_str_sequence_and_mode(&names, IdbTransactionMode::Readwrite)?;
        Ok([
            transaction.object_store(RUNS)?,
            transaction.object_store(PARTS)?,
        ])
    }

    fn store(&self, name: &str, writes: bool) -> Result<IdbObjectStore> {
        let mode = if writes {
            IdbTransactionMode::Readwrite
        } else {
            IdbTransactionMode::Readonly
        };
        let transaction = self.database.transaction_with_str_and_mode(name, mode)?;
        transaction.object_store(name)
    }
}

impl Drop for Database {
    fn drop(&mut self) {
        // An open one would keep the user from deleting all data. A closed one calls no closure.
        self.database.close();
    }
}

/// Deletes every run. Pages that have the database open close it when the browser asks.
///
/// # Errors
/// The browser has no database for this site. Then there are no runs either.
pub fn erase() -> Result<()> {
    factory()?.delete_database(NAME).map(drop)
}

fn factory() -> Result<IdbFactory> {
    Reflect::get(&js_sys::global(), &"indexedDB".into())?.dyn_into()
}

/// The headers of all runs.
#[derive(Debug)]
pub struct Headers {
    /// Those that this version can read.
    pub read: Vec<RunHeader>,
    /// Runs that another version of the page has written, and this one cannot read.
    pub unread: usize,
}

fn range(run: u32) -> Result<JsValue> {
    let first = f64::from(run) * PARTS_MAX;
    let end = first + PARTS_MAX;
    let range =
        IdbKeyRange::bound_with_lower_open_and_upper_open(&first.into(), &end.into(), false, true)?;
    Ok(range.into())
}

fn bytes_of<T: serde::Serialize>(value: &T) -> Result<Uint8Array> {
    let bytes = encode(value).map_err(|error| JsValue::from(error.to_string()))?;
    Ok(Uint8Array::from(bytes.as_slice()))
}

fn read_all<T: serde::de::DeserializeOwned>(all: &JsValue) -> Vec<T> {
    let read = |value: JsValue| {
        let bytes = value.dyn_into::<Uint8Array>().ok()?.to_vec();
        decode(&bytes).ok()
    };
    Array::from(all).iter().filter_map(read).collect()
}

/// Waits until what was written is stored. A full disk shows only then.
async fn stored(store: &IdbObjectStore) -> Result<()> {
    let transaction = store.transaction();
    let ended = Promise::new(&mut |resolve, reject| {
        transaction.set_oncomplete(Some(&resolve));
        transaction.set_onerror(Some(&reject));
        transaction.set_onabort(Some(&reject));
    });
    JsFuture::from(ended).await.map(drop)
}

/// The result of a request, once it has ended.
async fn done(request: &IdbRequest) -> Result<JsValue> {
    let ended = Promise::new(&mut |resolve, reject| {
        request.set_onsuccess(Some(&resolve));
        request.set_onerror(Some(&reject));
    });
    JsFuture::from(ended).await?;
    request.result()
}
