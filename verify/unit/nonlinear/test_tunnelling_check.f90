!> Tunnelling check: reports a node exactly where its straight path crosses the master.
!! SPDX-License-Identifier: GPL-3.0-or-later
program test_tunnelling_check
  use amontons_kinds, only: DP
  use amontons_errors, only: error_type
  use amontons_element_kinds, only: FACET_TRI3, FACET_QUAD4, FACET_TRI6, FACET_QUAD8, KIND_C3D6, KIND_C3D8, &
    KIND_C3D10, KIND_C3D20
  use amontons_mesh, only: mesh_type, finalize_mesh
  use amontons_facets, only: build_facets
  use amontons_slave_node_overrides, only: NODE_OVERRIDE_GIVES_WAY
  use amontons_state, only: slave_state_type
  use amontons_contact_pairs, only: contact_type
  use amontons_controls, only: newton_controls_type
  use amontons_tunnelling_check, only: find_tunnelled_slave
  use check, only: suite_type
  implicit none
  type(newton_controls_type), parameter :: CONTROLS = newton_controls_type()
  real(DP), parameter :: MIN_STEEPNESS = CONTROLS%min_crossing_steepness
  type(suite_type) :: suite
  integer :: kind
  do kind = FACET_TRI3, FACET_QUAD8
    call check_ways(suite, kind, [0.0_DP, 0.0_DP, 0.0_DP])
    call check_ways(suite, kind, [40.0_DP, -3.0_DP, 5.0_DP])
  end do
  call check_waves(suite)
  call check_first(suite)
  call check_rows(suite)
  call suite%finish()

contains

  include 'sample_surfaces.inc'

  !> A flat grid over [0, 9] x [0, 7] and slave nodes without projection, as contact stores them.
  subroutine make_pair(kind, mesh, contact)
    integer, intent(in) :: kind
    type(mesh_type), intent(out) :: mesh
    type(contact_type), intent(out) :: contact
    type(error_type), allocatable :: error
    integer, allocatable :: element(:), face(:)
    call flat_grid(kind, 9, 7, mesh, element, face)
    allocate (contact%facets(1))
    call build_facets(mesh, element, face, contact%facets(1), error)
    if (allocated(error)) error stop 'the sample surface is bad'
    contact%has_fixed_geometry = [.false.]
    contact%is_removed = [.false.]
    contact%edge = [maxval(contact%facets(1)%edge_length)]
  end subroutine make_pair


  !> Paths of all lengths and directions, with a moving master: crossing its plane within its border, from the front. A path with
  !! a normal part of less than a quarter of its length that ends beyond the border slid over the border.
  subroutine check_ways(suite, kind, motion)
    type(suite_type), intent(inout) :: suite
    integer, intent(in) :: kind
    real(DP), intent(in) :: motion(3)              !< of the master [length]
    real(DP), parameter :: EXTENT(2) = [9.0_DP, 7.0_DP]   ! of the master [length]
    real(DP), parameter :: SIZE_OF(3) = [12.0_DP, 10.0_DP, 8.0_DP]   ! of the region of the paths [length]
    real(DP), parameter :: CORNER(3) = [1.5_DP, 1.5_DP, 4.0_DP]
    type(mesh_type) :: mesh
    type(contact_type) :: contact
    type(slave_state_type) :: slave
    real(DP), allocatable :: x_old(:, :), x_new(:, :)
    real(DP) :: from(3), to(3), place(2), part
    integer :: i, n, n_wrong, n_through
    logical :: is_through
    call make_pair(kind, mesh, contact)
    n = mesh%n_nodes + 1
    x_old = reshape([mesh%coordinates, 0.0_DP, 0.0_DP, 0.0_DP], [3, n])
    x_new = x_old + spread(motion, 2, n)
    slave = slave_state_type(pair=1, node=n)
    n_wrong = 0
    n_through = 0
    do i = 1, 2000
      from = SIZE_OF * modulo([0.819173_DP, 0.671044_DP, 0.549700_DP] * real(i, DP), 1.0_DP) - CORNER
      to = SIZE_OF * modulo([0.754878_DP, 0.569840_DP, 0.347810_DP] * real(i, DP), 1.0_DP) - CORNER
      if (min(abs(from(3)), abs(to(3))) < 0.01_DP) cycle   ! below MIN_FRONT_DISTANCE
      part = from(3) / (from(3) - to(3))
      place = from(:2) + part * (to(:2) - from(:2))
      is_through = from(3) > 0.0_DP .and. to(3) < 0.0_DP .and. all(place > 0.0_DP .and. place < EXTENT)
      if (from(3) - to(3) < 0.25_DP * norm2(to - from)) is_through = is_through .and. all(to(:2) > 0.0_DP .and. to(:2) < EXTENT)
      x_old(:, n) = from
      x_new(:, n) = to + motion
      if ((find_tunnelled_slave(contact, x_old, x_new, [slave], [slave], MIN_STEEPNESS) > 0) .neqv. is_through) &
        n_wrong = n_wrong + 1
      if (is_through) n_through = n_through + 1
    end do
    call suite%that('some ways go through', n_through > 200)
    call suite%that('they are found, and no others', n_wrong == 0)
  end subroutine check_ways


  !> A row of surface-to-surface contact faces the grid: its node may lie behind it within the search depth, as the mean gap admits,
  !! but not deeper; nor may it if the row faces the other way, or nothing.
  subroutine check_rows(suite)
    type(suite_type), intent(inout) :: suite
    type(mesh_type) :: mesh
    type(contact_type) :: contact
    type(slave_state_type) :: old, new
    real(DP), allocatable :: x_old(:, :), x_new(:, :)
    call make_pair(FACET_QUAD4, mesh, contact)
    x_old = reshape([mesh%coordinates, 4.3_DP, 3.2_DP, 0.5_DP], [3, mesh%n_nodes + 1])
    x_new = x_old
    old = slave_state_type(pair=1, node=size(x_old, 2), row=1)
    new = slave_state_type(pair=1, node=size(x_old, 2), row=1, facet=1, normal=[0.0_DP, 0.0_DP, 1.0_DP])
    x_new(3, size(x_old, 2)) = -0.2_DP
    call suite%that('a node may lie behind what its row faces', .not. is_found(contact, x_old, x_new, new))
    new%normal = -new%normal
    call suite%that('but not if the row faces the other way', is_found(contact, x_old, x_new, new))
    call suite%that('nor if it faces nothing', is_found(contact, x_old, x_new, old))
    new%normal = -new%normal
    new%row = 0
    call suite%that('nor without a row', is_found(contact, x_old, x_new, new))
    new%row = 1
    x_new(3, size(x_old, 2)) = -3.5_DP * contact%edge(1)
    call suite%that('nor beyond the search depth', is_found(contact, x_old, x_new, new))
  end subroutine check_rows


  !> Whether the check finds one node, which had no projection before.
  logical function is_found(contact, x_old, x_new, state)
    type(contact_type), intent(in) :: contact
    real(DP), intent(in) :: x_old(:, :), x_new(:, :)   !< (3, n_nodes) [length]
    type(slave_state_type), intent(in) :: state    !< at the end
    is_found = find_tunnelled_slave(contact, x_old, x_new, [slave_state_type(pair=1, node=state%node, row=state%row)], [state], &
      MIN_STEEPNESS) > 0
  end function is_found


  !> Every downward path crosses a wavy and folded surface of triangles; a path that stays above does not.
  subroutine check_waves(suite)
    type(suite_type), intent(inout) :: suite
    type(mesh_type) :: mesh
    type(contact_type) :: contact
    type(slave_state_type) :: slave
    real(DP), allocatable :: x_old(:, :), x_new(:, :)
    real(DP) :: place(2)
    integer :: i, n, n_through, n_above
    call make_pair(FACET_TRI3, mesh, contact)
    call shake(mesh, 0.5_DP, 0.05_DP)
    call fold(mesh, 7.0_DP, 0.5_DP)
    n = mesh%n_nodes + 1
    x_old = reshape([mesh%coordinates, 0.0_DP, 0.0_DP, 0.0_DP], [3, n])
    x_new = x_old
    slave = slave_state_type(pair=1, node=n)
    n_through = 0
    n_above = 0
    do i = 1, 500
      place = 0.5_DP + [7.5_DP, 6.0_DP] * modulo([0.754878_DP, 0.569840_DP] * real(i, DP), 1.0_DP)
      x_old(:, n) = [place, 2.0_DP]
      x_new(:, n) = [place, -4.0_DP]
      if (find_tunnelled_slave(contact, x_old, x_new, [slave], [slave], MIN_STEEPNESS) > 0) n_through = n_through + 1
      x_new(:, n) = [place(2:1:-1), 1.0_DP]
      if (find_tunnelled_slave(contact, x_old, x_new, [slave], [slave], MIN_STEEPNESS) > 0) n_above = n_above + 1
    end do
    call suite%that('all that go down are found', n_through == 500)
    call suite%that('none that stays above is', n_above == 0)
  end subroutine check_waves


  !> The first of several nodes that tunnelled is reported; nodes of a removed pair, or inactive in a shared pair, do not count.
  subroutine check_first(suite)
    type(suite_type), intent(inout) :: suite
    type(mesh_type) :: mesh
    type(contact_type) :: contact
    type(slave_state_type) :: slaves(4)
    real(DP), allocatable :: x_old(:, :), x_new(:, :)
    integer :: i, n
    call make_pair(FACET_TRI3, mesh, contact)
    n = mesh%n_nodes
    slaves = [(slave_state_type(pair=1, node=n + i), i=1, 4)]
    x_old = reshape([mesh%coordinates, (4.3_DP, 3.0_DP + real(i, DP), 1.0_DP, i=1, 4)], [3, n + 4])
    x_new = x_old
    x_new(3, n + 2:n + 3) = -1.0_DP
    call suite%that('the first that passed', find_tunnelled_slave(contact, x_old, x_new, slaves, slaves, MIN_STEEPNESS) == 2)
    slaves(2)%overrides%side = NODE_OVERRIDE_GIVES_WAY
    call suite%that('another side watches', find_tunnelled_slave(contact, x_old, x_new, slaves, slaves, MIN_STEEPNESS) == 3)
    contact%is_removed(1) = .true.
    call suite%that('a pair that is out', find_tunnelled_slave(contact, x_old, x_new, slaves, slaves, MIN_STEEPNESS) == 0)
  end subroutine check_first

end program test_tunnelling_check
