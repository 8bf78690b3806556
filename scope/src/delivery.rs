//! A file on its way to a page.

use std::convert::Infallible;
use std::pin::Pin;
use std::task::{Context, Poll};

use axum::body::Bytes;
use futures_core::Stream;

/// Bytes that the connection takes at a time.
const PART: usize = 1 << 16;

/// A body in parts, which tells once that the connection has taken all of them. A page that asks for the head, or ends
/// before, gets no whole file.
pub(crate) struct Delivery<F> {
    rest: Bytes,
    /// `None` once it was called.
    delivered: Option<F>,
}

impl<F: FnOnce()> Delivery<F> {
    /// The body of these bytes, and what is called at its end.
    pub(crate) fn new(bytes: Vec<u8>, delivered: F) -> Self {
        Self {
            rest: bytes.into(),
            delivered: Some(delivered),
        }
    }
}

impl<F: FnOnce() + Unpin> Stream for Delivery<F> {
    type Item = Result<Bytes, Infallible>;

    fn poll_next(self: Pin<&mut Self>, _: &mut Context<'_>) -> Poll<Option<Self::Item>> {
        let this = self.get_mut();
        if this.rest.is_empty() {
            if let Some(delivered) = this.delivered.take() {
                delivered();
            }
            return Poll::Ready(None);
        }
        let part = this.rest.split_to(PART.min(this.rest.len()));
        Poll::Ready(Some(Ok(part)))
    }
}

#[cfg(test)]
mod tests {
    use std::cell::Cell;
    use std::task::Waker;

    use super::*;

    #[test]
    fn file_counts_as_delivered_when_the_connection_has_taken_all_of_it() {
        let bytes: Vec<u8> = (0..=u8::MAX).cycle().take(2 * PART + 1).collect();
        let delivered = Cell::new(0);
        let mut context = Context::from_waker(Waker::noop());
        let mut all = Vec::new();
        let mut file = Delivery::new(bytes.clone(), || delivered.set(delivered.get() + 1));
        for _ in 0..3 {
            assert_eq!(delivered.get(), 0);
            let Poll::Ready(Some(Ok(part))) = Pin::new(&mut file).poll_next(&mut context) else {
                panic!("a part");
            };
            all.extend(part);
        }
        assert_eq!((all, delivered.get()), (bytes, 0));
        for _ in 0..2 {
            assert!(matches!(
                Pin::new(&mut file).poll_next(&mut context),
                Poll::Ready(None)
            ));
            assert_eq!(delivered.get(), 1);
        }
    }
}
