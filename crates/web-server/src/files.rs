//! The files of one directory, read only.

use std::io;
use std::path::Path;
use std::sync::Arc;

use axum::Router;
use axum::extract::{Request, State};
use axum::http::header::{CACHE_CONTROL, CONTENT_TYPE, X_CONTENT_TYPE_OPTIONS};
use axum::http::{HeaderMap, HeaderValue, StatusCode};
use axum::middleware::{self, Next};
use axum::response::{IntoResponse, Response};
use percent_encoding::percent_decode_str;
use tower_http::compression::CompressionLayer;
use tower_http::services::ServeDir;

/// How files are sent.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Delivery {
    /// As a host does: compressed with gzip for a browser that accepts it. The browser asks each
    /// time whether a file has changed, so that a page shows at once after it was built again.
    AsAHost,
    /// Uncompressed, and the browser keeps no file: for tests, each of which has a port and a
    /// profile of its own, so that a cache could only be wrong.
    Uncached,
}

impl Delivery {
    fn cache_control(self) -> HeaderValue {
        HeaderValue::from_static(match self {
            Self::AsAHost => "no-cache",
            Self::Uncached => "no-store",
        })
    }
}

/// Answers GET and HEAD requests with the files of a directory and its subdirectories; for a
/// directory with its `index.html`. Nothing outside is reachable, not through a link either.
///
/// # Errors
///
/// When the directory does not exist.
pub fn files(dir: &Path, delivery: Delivery) -> io::Result<Router> {
    let root: Arc<Path> = dir.canonicalize()?.into();
    let router = Router::new()
        .fallback_service(ServeDir::new(&root))
        .layer(middleware::from_fn_with_state(root, refuse_outside));
    let router = match delivery {
        Delivery::AsAHost => router.layer(CompressionLayer::new()),
        Delivery::Uncached => router,
    };
    let complete = move |response| async move { complete(response, delivery) };
    Ok(router.layer(middleware::map_response(complete)))
}

/// `ServeDir` refuses a path that leaves the directory, but follows a link that does.
async fn refuse_outside(State(root): State<Arc<Path>>, request: Request, next: Next) -> Response {
    let path = percent_decode_str(request.uri().path()).decode_utf8_lossy();
    let file = root.join(path.trim_start_matches('/')).canonicalize();
    if file.is_ok_and(|file| !file.starts_with(&root)) {
        return StatusCode::NOT_FOUND.into_response();
    }
    next.run(request).await
}

/// Adds the headers that every answer has, and a text to one without a file.
fn complete(mut response: Response, delivery: Delivery) -> Response {
    if response.status() == StatusCode::NOT_FOUND {
        response = (StatusCode::NOT_FOUND, "no such file").into_response();
    }
    let headers = response.headers_mut();
    headers.insert(CACHE_CONTROL, delivery.cache_control());
    headers.insert(X_CONTENT_TYPE_OPTIONS, HeaderValue::from_static("nosniff"));
    name_charset(headers);
    response
}

/// Every text of the site is UTF-8; `ServeDir` names the type alone.
fn name_charset(headers: &mut HeaderMap) {
    let Some(Ok(text)) = headers.get(CONTENT_TYPE).map(HeaderValue::to_str) else {
        return;
    };
    if text.starts_with("text/") && !text.contains("charset") {
        let text = format!("{text}; charset=utf-8");
        if let Ok(value) = HeaderValue::try_from(text) {
            headers.insert(CONTENT_TYPE, value);
        }
    }
}
