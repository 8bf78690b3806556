//! The serial port: USART3, which ST-LINK shows the host as a serial port on USB. DMA moves its bytes,
//! and no interrupt is taken.

use drivers::link::BAUD;
use firmware_app::port::{Inbox, Outbox, PortFaults};
use firmware_rt::serial::{
    Chunk, RECEIVE_RING, ReceiveRing, TRANSMIT_RING, line_error, received, store_transmitted,
};
use stm32f4xx_hal::dma::config::DmaConfig;
use stm32f4xx_hal::dma::{
    DmaFlag, MemoryToPeripheral, PeripheralToMemory, Stream1, Stream3, StreamsTuple, Transfer,
};
use stm32f4xx_hal::gpio::{PD8, PD9};
use stm32f4xx_hal::pac::{DMA1, USART3};
use stm32f4xx_hal::prelude::*;
use stm32f4xx_hal::rcc::Rcc;
use stm32f4xx_hal::serial::config::{Config, DmaConfig as Requests};
use stm32f4xx_hal::serial::{Rx3, Serial3, Tx3};

use super::parts::CORE_HZ;
use crate::boards::Port;

/// Clock of the port, Hz: that of APB1.
const CLOCK_HZ: u32 = CORE_HZ / 4;
// ST-LINK has 36 MHz, whose divider of 1.5 Mbaud is whole too.
const _: () = assert!(CLOCK_HZ.is_multiple_of(BAUD), "the baud rate is not exact");

/// Channel of both streams.
const CHANNEL: u8 = 4;

/// Fills the ring of received bytes, for ever.
type Receiver = Transfer<Stream1<DMA1>, CHANNEL, Rx3, PeripheralToMemory, ReceiveRing>;
/// Sends a chunk of the ring of frames.
type Transmitter = Transfer<Stream3<DMA1>, CHANNEL, Tx3, MemoryToPeripheral, Chunk>;

/// USART3 and its two DMA streams.
pub(super) struct Usart {
    receiver: Receiver,
    transmitter: Transmitter,
    inbox: Inbox<RECEIVE_RING>,
    outbox: Outbox<TRANSMIT_RING>,
    /// Whether the transmitter has a chunk to send.
    sending: bool,
    errors: u32,
}

impl Usart {
    /// The port on its pins, receiving. `None` if the clocks do not give its baud rate.
    pub(super) fn start(
        usart: USART3,
        dma: DMA1,
        (tx, rx): (PD8, PD9),
        rcc: &mut Rcc,
    ) -> Option<Self> {
        // An unplugged line rests.
        let rx = rx.into_alternate().internal_pull_up(true);
        let config = Config::default().baudrate(BAUD.bps()).dma(Requests::TxRx);
        let (tx, rx) = Serial3::new(usart, (tx, rx), config, rcc).ok()?.split();
        let streams = StreamsTuple::new(dma, rcc);
        let memory = DmaConfig::default().memory_increment(true);
        // A stream whose two buffers are the same one goes round it.
        let mut receiver = Transfer::init_peripheral_to_memory(
            streams.1,
            rx,
            ReceiveRing,
            Some(ReceiveRing),
            memory.double_buffer(true),
        );
        receiver.start(|_| ());
        let transmitter =
            Transfer::init_memory_to_peripheral(streams.3, tx, Chunk::new(0, 0), None, memory);
        Some(Self {
            receiver,
            transmitter,
            inbox: Inbox::default(),
            outbox: Outbox::default(),
            sending: false,
            errors: 0,
        })
    }
}

impl Port for Usart {
    fn look(&mut self) {
        let mut errors = u32::from(line_error());
        if self.receiver.flags().contains(DmaFlag::TransferError) {
            // The stream has stopped; it and its reader begin at the start of the ring.
            self.receiver.clear_all_flags();
            self.receiver.start(|_| ());
            self.inbox = Inbox::default();
            errors += 1;
        }
        if self.sending {
            let flags = self.transmitter.flags();
            errors += u32::from(flags.contains(DmaFlag::TransferError));
            self.sending = !flags.intersects(DmaFlag::TransferComplete | DmaFlag::TransferError);
        }
        self.errors = self.errors.wrapping_add(errors);
        if self.sending {
            return;
        }
        if let Some((start, length)) = self.outbox.chunk() {
            self.transmitter.clear_all_flags();
            self.sending = self
                .transmitter
                .next_transfer(Chunk::new(start, length))
                .is_ok();
        }
    }

    fn receive(&mut self) -> Option<u8> {
        let left = self.receiver.number_of_transfers();
        self.inbox.take(left).map(received)
    }

    fn send(&mut self, frame: &[u8]) {
        self.outbox.put(frame, store_transmitted);
    }

    fn faults(&self) -> PortFaults {
        PortFaults {
            errors: self.errors,
            lost: self.outbox.lost(),
        }
    }
}
