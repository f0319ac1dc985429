//! Files dropped on a real window by the desktop's protocol, as a file manager does it (XDND,
//! version 5).

use super::desk::{Desk, POLL};
use super::real::MIDDLE;
use super::*;
use std::path::Path;
use std::thread::sleep;
use x11rb::connection::Connection;
use x11rb::protocol::Event;
use x11rb::protocol::xproto::{
    ClientMessageEvent, ConnectionExt, CreateWindowAux, EventMask, PropMode, SelectionNotifyEvent,
    SelectionRequestEvent, WindowClass,
};
use x11rb::rust_connection::RustConnection;
use x11rb::wrapper::ConnectionExt as _;
use x11rb::{COPY_DEPTH_FROM_PARENT, CURRENT_TIME};

const VERSION: u32 = 5;

x11rb::atom_manager! {
    Atoms: AtomsCookie {
        XdndEnter,
        XdndPosition,
        XdndStatus,
        XdndDrop,
        XdndFinished,
        XdndSelection,
        XdndActionCopy,
        UriList: b"text/uri-list",
    }
}

/// A client that drags a file: it owns the selection that names the file.
struct Source {
    connection: RustConnection,
    atoms: Atoms,
    own: u32,
    target: u32,
    uri: String,
}

impl Source {
    fn new(display: &str, target: u32, file: &Path) -> Self {
        let (connection, screen) = x11rb::connect(Some(display)).expect("the display");
        let atoms = Atoms::new(&connection).expect("atoms").reply().expect("atoms");
        let (root, own) = (connection.setup().roots[screen].root, connection.generate_id().expect("an id"));
        let look = CreateWindowAux::new();
        let class = WindowClass::INPUT_OUTPUT;
        connection
            .create_window(COPY_DEPTH_FROM_PARENT, own, root, 0, 0, 1, 1, 0, class, 0, &look)
            .expect("a window");
        connection.set_selection_owner(own, atoms.XdndSelection, CURRENT_TIME).expect("the selection");
        Self { connection, atoms, own, target, uri: format!("file://{}\r\n", file.display()) }
    }

    fn tell(&self, message: u32, data: [u32; 5]) {
        let event = ClientMessageEvent::new(32, self.target, message, data);
        self.connection.send_event(false, self.target, EventMask::NO_EVENT, event).expect("a message");
        self.connection.flush().expect("the display");
    }

    fn hand_over(&self, asked: &SelectionRequestEvent) {
        let (requestor, property) = (asked.requestor, asked.property);
        self.connection
            .change_property8(PropMode::REPLACE, requestor, property, asked.target, self.uri.as_bytes())
            .expect("the names");
        let reply = SelectionNotifyEvent {
            response_type: x11rb::protocol::xproto::SELECTION_NOTIFY_EVENT,
            sequence: 0,
            time: asked.time,
            requestor,
            selection: asked.selection,
            target: asked.target,
            property,
        };
        self.connection.send_event(false, requestor, EventMask::NO_EVENT, reply).expect("a message");
        self.connection.flush().expect("the display");
    }

    /// Enters, moves to a point of the screen, drops once the target has read the names, and waits
    /// for the confirmation.
    fn drop_at(&self, x: u32, y: u32) {
        let atoms = &self.atoms;
        self.tell(atoms.XdndEnter, [self.own, VERSION << 24, atoms.UriList, 0, 0]);
        self.tell(atoms.XdndPosition, [self.own, 0, x << 16 | y, CURRENT_TIME, atoms.XdndActionCopy]);
        let (mut has_names, mut is_welcome, mut is_dropped) = (false, false, false);
        let start = Instant::now();
        loop {
            assert!(start.elapsed() < DEADLINE, "names taken: {has_names}, welcome: {is_welcome}");
            match self.connection.poll_for_event().expect("the display") {
                Some(Event::SelectionRequest(asked)) => {
                    self.hand_over(&asked);
                    has_names = true;
                }
                Some(Event::ClientMessage(reply)) if reply.type_ == atoms.XdndStatus => {
                    is_welcome = reply.data.as_data32()[1] & 1 == 1;
                }
                Some(Event::ClientMessage(reply)) if reply.type_ == atoms.XdndFinished => return,
                Some(_) => {}
                None => sleep(POLL),
            }
            if has_names && is_welcome && !is_dropped {
                self.tell(atoms.XdndDrop, [self.own, 0, CURRENT_TIME, 0, 0]);
                is_dropped = true;
            }
        }
    }
}

fn drop_file(desk: &Desk, file: &Path) {
    let point: Vec<u32> = MIDDLE.split(' ').map(|n| n.parse().expect("a number")).collect();
    Source::new(desk.display(), desk.window(), file).drop_at(point[0], point[1]);
}

#[test]
fn a_dropped_model_is_opened_and_a_dropped_picture_leads_back_to_its_view() {
    let Some(desk) = Desk::open() else { return };
    let start = desk.pose();
    let far = desk.folder().join("far.obj");
    std::fs::write(&far, "v 100 0 0\nv 104 0 0\nv 104 3 0\nv 100 3 0\nf 1 2 3 4\n").expect("a model");
    drop_file(&desk, &far);
    desk.wait_for("the dropped model", || (desk.pose().eye.x > 50.0).then_some(()));
    let there = desk.pose();
    assert!(start.eye.x < 50.0);

    desk.xdotool("key F12");
    let picture = desk.wait_for("a picture", || desk.saved("png"));
    desk.fly("s", there.eye);
    drop_file(&desk, &picture);
    desk.wait_for("the picture's view", || (desk.pose().eye.distance(there.eye) < 1e-3).then_some(()));
    let back = desk.pose();
    assert!((back.yaw - there.yaw).abs() < 1e-6 && (back.pitch - there.pitch).abs() < 1e-6);
}
