use super::*;

#[test]
fn a_second_forward_is_the_speed_in_metres() {
    let mut fly = FlyCamera::default();
    for _ in 0..10 {
        fly.advance(&Motion { forward: 1.0, factor: 1.0, ..Motion::default() }, 0.1, None);
    }
    assert!((fly.camera().eye - DVec3::new(0.0, 0.0, -DEFAULT_SPEED)).length() < 1e-9);
}

#[test]
fn diagonals_are_no_faster_and_a_hitch_does_not_fly_through_walls() {
    let mut fly = FlyCamera::default();
    fly.advance(&Motion { forward: 1.0, right: 1.0, factor: 1.0, ..Motion::default() }, 100.0, None);
    assert!((fly.camera().eye.length() - DEFAULT_SPEED * LONGEST_STEP_SECS).abs() < 1e-9);
}

#[test]
fn dragging_right_looks_right_and_down_looks_down_but_never_over() {
    let mut fly = FlyCamera::default();
    fly.look([0.1, 0.1]);
    assert!(fly.camera().forward().x > 0.0 && fly.camera().forward().y < 0.0);
    fly.look([0.0, 100.0]);
    assert_eq!(fly.camera().pitch, -FRAC_PI_2);
}

#[test]
fn easing_arrives_exactly_and_goes_the_shorter_way() {
    let mut fly = FlyCamera::default();
    fly.jump_to(Camera { yaw: 3.0, ..*fly.camera() });
    let target = Camera { yaw: -3.0, eye: DVec3::ONE, ..*fly.camera() };
    fly.ease_to(target);
    fly.advance(&Motion::default(), EASE_SECS[0] / 2.0, None);
    assert!(fly.camera().yaw > 3.0, "turned the long way: {}", fly.camera().yaw);
    fly.advance(&Motion::default(), EASE_SECS[1], None);
    assert_eq!(*fly.camera(), target);
    assert!(!fly.is_easing());
}

#[test]
fn ones_own_motion_ends_an_eased_one() {
    let mut fly = FlyCamera::default();
    fly.ease_to(Camera { eye: DVec3::splat(100.0), ..*fly.camera() });
    fly.look([0.1, 0.0]);
    fly.advance(&Motion::default(), 1.0, None);
    assert_eq!(fly.camera().eye, DVec3::ZERO);
}

#[test]
fn speed_and_field_of_view_stay_in_range() {
    let mut fly = FlyCamera::default();
    fly.change_speed(1000.0);
    assert_eq!(fly.speed_m_per_s(), *SPEED_RANGE.end());
    fly.change_speed(-1000.0);
    assert_eq!(fly.speed_m_per_s(), *SPEED_RANGE.start());
    fly.change_fov(1000.0);
    assert!(fly.camera().is_valid());
}

#[test]
fn speed_suits_the_building_and_not_what_surrounds_it() {
    let speed = |diagonal: f64| speed_for([DVec3::ZERO, DVec3::X * diagonal]);
    assert_eq!([5.0, 18.0, 100.0].map(speed), [DEFAULT_SPEED; 3]);
    assert_eq!([1.0, 400.0].map(speed), [0.5, 10.0]);
    assert_eq!([0.0, 1e100].map(speed), [*SPEED_RANGE.start(), *SPEED_RANGE.end()]);
}

#[test]
fn the_wheel_moves_towards_the_cursor() {
    let mut fly = FlyCamera::default();
    fly.dolly(fly.direction_through(1.0, 0.0, 2.0), 1.0, 1.0, None);
    assert!(fly.camera().eye.x > 0.0 && fly.camera().eye.z < 0.0);
}

#[test]
fn small_changes_are_quick_large_ones_slower_and_none_is_eased_where_motion_is_unwanted() {
    let mut fly = FlyCamera::default();
    let secs = |to: Camera| ease_secs(&FlyCamera::default().camera, &to);
    assert_eq!(secs(*fly.camera()), EASE_SECS[0]);
    assert_eq!(secs(Camera { eye: DVec3::X * 1e3, ..*fly.camera() }), EASE_SECS[1]);
    assert!((EASE_SECS[0]..EASE_SECS[1]).contains(&secs(Camera { yaw: 1.0, ..*fly.camera() })));
    fly.set_view_change(ViewChange::AtOnce);
    let target = Camera { eye: DVec3::ONE, ..*fly.camera() };
    fly.ease_to(target);
    assert_eq!((*fly.camera(), fly.is_easing()), (target, false));
}

#[test]
fn a_walker_who_looks_down_still_goes_ahead() {
    let mut fly = FlyCamera::default();
    fly.set_move_mode(MoveMode::Walk);
    fly.look([0.0, 0.2]);
    fly.advance(&Motion { forward: 1.0, up: 1.0, factor: 1.0, ..Motion::default() }, 0.1, None);
    let eye = fly.camera().eye;
    assert!((eye - DVec3::new(0.0, 0.0, -0.1 * DEFAULT_SPEED)).length() < 1e-9, "{eye}");
}
