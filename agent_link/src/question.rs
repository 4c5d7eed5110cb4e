//! A query that somebody waits for.

use std::borrow::Cow;
use std::sync::Arc;

use tokio::runtime::Handle;
use zenoh::bytes::ZBytes;
use zenoh::query::Query;

use crate::keys::Keys;
use crate::wire::{self, WireError};

/// A query, and the key under which it is answered.
///
/// Answering is done elsewhere and never waits: sending may take as long as a slow network likes.
#[derive(Debug)]
pub struct Question {
    query: Query,
    /// Ours, not the query's: that one may have wildcards.
    key: Arc<str>,
    /// Who asks, where the key says so.
    asker: Option<Arc<str>>,
    runtime: Handle,
}

impl Question {
    pub(crate) fn new(query: Query, runtime: &Handle, key: Arc<str>) -> Self {
        Self {
            query,
            key,
            asker: None,
            runtime: runtime.clone(),
        }
    }

    /// One of somebody whom the query's key names at its end. `None` if it names nobody.
    pub(crate) fn signed(query: Query, runtime: &Handle) -> Option<Self> {
        let key: Arc<str> = Arc::from(query.key_expr().as_str());
        let asker = Some(Arc::from(Keys::read_last(&key)?));
        Some(Self {
            asker,
            ..Self::new(query, runtime, key)
        })
    }

    /// Who asks, where the key says so.
    pub(crate) fn asker(&self) -> Option<&Arc<str>> {
        self.asker.as_ref()
    }

    /// What came with it, unless that is too much.
    pub fn content(
        &self,
        what: &'static str,
        limit_bytes: usize,
    ) -> Result<Cow<'_, [u8]>, WireError> {
        match self.query.payload() {
            Some(payload) => bounded(payload, limit_bytes),
            None => Err(WireError::malformed(what, "the query has no content")),
        }
    }

    /// What came with it, as text; `None` if that is nothing or no short text.
    pub fn text(&self) -> Option<String> {
        let content = self.content("question", wire::USER_LIMIT_BYTES).ok()?;
        let text = std::str::from_utf8(&content).ok()?.trim();
        (!text.is_empty()).then(|| text.to_owned())
    }

    /// Sends the answer, soon. One that cannot be written is our mistake and leaves the question
    /// open, which whoever asked takes for a lost answer.
    pub fn answer(self, text: Result<String, WireError>) {
        let text = match text {
            Ok(text) => text,
            Err(error) => {
                tracing::error!("cannot write the answer on {}: {error}", self.key);
                return;
            }
        };
        let Self {
            query,
            key,
            runtime,
            asker: _,
        } = self;
        runtime.spawn(async move {
            if let Err(error) = query.reply(&*key, text).await {
                tracing::warn!("cannot answer on {key}: {error}");
            }
            // Dropping the query tells whoever asked that this was all.
        });
    }
}

/// The bytes, which may be copied for it, unless there are too many.
pub(crate) fn bounded(payload: &ZBytes, limit_bytes: usize) -> Result<Cow<'_, [u8]>, WireError> {
    if payload.len() > limit_bytes {
        return Err(WireError::TooLarge {
            bytes: payload.len(),
            limit_bytes,
        });
    }
    Ok(payload.to_bytes())
}
