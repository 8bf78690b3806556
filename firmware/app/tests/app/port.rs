use std::collections::VecDeque;

use firmware_app::port::{Inbox, Outbox};

const N: usize = 8;

/// DMA that fills a ring: its counter has what is left, and starts again at the end of the ring.
#[test]
fn inbox_gives_every_byte_once_in_order() {
    let mut ring = [0_u8; N];
    let mut inbox = Inbox::<N>::default();
    let (mut left, mut next, mut read) = (N, 0_u8, Vec::new());
    for burst in [0, 1, 7, 3, 5, 2, 6, 7, 1] {
        for _ in 0..burst {
            ring[N - left] = next;
            next += 1;
            left = if left == 1 { N } else { left - 1 };
        }
        while let Some(at) = inbox.take(left as u16) {
            read.push(ring[at]);
        }
    }
    assert_eq!(read, (0..next).collect::<Vec<_>>());
}

/// The counter is 0 for a moment before it starts again.
#[test]
fn inbox_takes_an_ended_counter_for_a_full_one() {
    let mut inbox = Inbox::<N>::default();
    assert_eq!(inbox.take(0), None);
    assert_eq!(inbox.take(N as u16 - 1), Some(0));
    for at in 1..N {
        assert_eq!(inbox.take(0), Some(at));
    }
    assert_eq!(inbox.take(0), None);
}

/// Frames of every length, sent in the chunks that the outbox hands out: what it took arrives, whole
/// and in order, and what it did not take is counted.
#[test]
fn outbox_sends_whole_frames_and_counts_the_others() {
    let mut ring = [0_u8; N];
    let mut outbox = Outbox::<N>::default();
    let (mut sent, mut wanted) = (VecDeque::new(), VecDeque::new());
    let mut lost = 0;
    for round in 0_u8..200 {
        let frame: Vec<u8> = (0..round % 10).map(|k| round.wrapping_add(k)).collect();
        let before = outbox.lost();
        outbox.put(&frame, |at, byte| ring[at] = byte);
        if outbox.lost() == before {
            wanted.extend(frame);
        } else {
            lost += 1;
        }
        // DMA is slower than the frames come.
        if round % 3 > 0
            && let Some((start, length)) = outbox.chunk()
        {
            sent.extend(&ring[start..start + length]);
        }
    }
    while let Some((start, length)) = outbox.chunk() {
        sent.extend(&ring[start..start + length]);
    }
    assert_eq!(sent, wanted);
    assert_eq!(outbox.lost(), lost);
    assert!(lost > 50 && wanted.len() > 100, "{lost}, {}", wanted.len());
}

/// Bytes that DMA is sending are not overwritten: they leave the ring when the next are asked for.
#[test]
fn outbox_keeps_the_bytes_that_are_being_sent() {
    let mut outbox = Outbox::<N>::default();
    outbox.put(&[0; 5], |_, _| ());
    assert_eq!(outbox.chunk(), Some((0, 5)));
    outbox.put(&[0; 3], |_, _| panic!("no place"));
    assert_eq!(outbox.lost(), 1);
    outbox.put(&[0; 2], |at, _| assert!(at >= 5));
    assert_eq!(outbox.chunk(), Some((5, 2)));
    outbox.put(&[0; 5], |at, _| assert!(at < 4 || at == 7));
    assert_eq!(outbox.chunk(), Some((7, 1)));
    assert_eq!(outbox.chunk(), Some((0, 4)));
    assert_eq!(outbox.chunk(), None);
}
