!> Unit test of free_rigid_motions: two tetrahedra of bars, whose rigid motions are known, under several supports.
!! SPDX-License-Identifier: GPL-3.0-or-later
program test_free_rigid_motions
  use amontons_kinds, only: DP
  use amontons_errors, only: error_type
  use amontons_tensor, only: outer_product
  use amontons_sparse, only: sparse_type, sparse_from_triplets, multiply_symmetric
  use amontons_constraints, only: constraints_type, constraint_row_type, reset_constraints, prescribe_unknown, &
    add_constraint_row, eliminate_constraints
  use amontons_controls, only: skin_controls_type, globalization_controls_type
  use amontons_free_rigid_motions, only: free_motions_type, sparse_vector_type, find_motions, motion_of, compressed, &
    is_singular_along
  use check, only: suite_type
  implicit none
  integer, parameter :: N_NODES = 8, N = 3 * N_NODES
  type(skin_controls_type), parameter :: CONTROLS = skin_controls_type()
  real(DP), parameter :: FREE_RATIO = CONTROLS%free_motion_ratio
  type(suite_type) :: suite
  type(sparse_type) :: K
  real(DP) :: place(3, N_NODES)
  call make_bodies(place, K)
  call check_supports()
  call check_coupled_bodies()
  call check_hinge()
  call check_singularity()
  call check_proximal_shift()
  call suite%finish()

contains

  !> Two tetrahedra, each with six bars of unit stiffness: an elastic body with six motions without energy.
  subroutine make_bodies(place, K)
    real(DP), intent(out) :: place(3, N_NODES)
    type(sparse_type), intent(out) :: K            !< upper triangle
    type(error_type), allocatable :: error
    real(DP) :: dense(N, N), axis(3), bar(3, 3)
    integer :: row(N * N), column(N * N), i, j, b, m
    real(DP) :: value(N * N)
    place(:, 1) = 0.0_DP
    place(:, 2) = [1.0_DP, 0.1_DP, 0.0_DP]
    place(:, 3) = [0.2_DP, 1.1_DP, 0.0_DP]
    place(:, 4) = [0.3_DP, 0.2_DP, 0.9_DP]
    place(:, 5:8) = 2.0_DP * place(:, 1:4) + 5.0_DP
    dense = 0.0_DP
    do b = 0, 4, 4
      do i = b + 1, b + 4
        do j = i + 1, b + 4
          axis = (place(:, j) - place(:, i)) / norm2(place(:, j) - place(:, i))
          bar = outer_product(axis, axis)
          dense(3 * i - 2:3 * i, 3 * i - 2:3 * i) = dense(3 * i - 2:3 * i, 3 * i - 2:3 * i) + bar
          dense(3 * j - 2:3 * j, 3 * j - 2:3 * j) = dense(3 * j - 2:3 * j, 3 * j - 2:3 * j) + bar
          dense(3 * i - 2:3 * i, 3 * j - 2:3 * j) = -bar
        end do
      end do
    end do
    m = 0
    do i = 1, N
      do j = i, N
        if ((i - 1) / 12 /= (j - 1) / 12) cycle    ! all entries of a body's blocks, also zeros
        m = m + 1
        row(m) = i
        column(m) = j
        value(m) = dense(i, j)
      end do
    end do
    call sparse_from_triplets(N, N, row(:m), column(:m), value(:m), K, error)
  end subroutine make_bodies


  !> The motions under supports of the given unknowns.
  subroutine motions_of(held, motions, row)
    integer, intent(in) :: held(:)
    type(free_motions_type), intent(out) :: motions
    type(constraint_row_type), intent(in), optional :: row(:)
    type(constraints_type) :: base
    integer :: i, status
    logical :: is_angle(N_NODES)
    call reset_constraints(base, N)
    do i = 1, size(held)
      call prescribe_unknown(base, held(i), 0.0_DP)
    end do
    if (present(row)) then
      do i = 1, size(row)
        call add_constraint_row(base, row(i), 1, 1.0e-9_DP, status)
      end do
    end if
    call eliminate_constraints(base)
    is_angle = .false.
    call find_motions(skin_controls_type(), K, base, place, is_angle, motions)
  end subroutine motions_of


  !> All kept motions in columns.
  pure function columns(motions) result(z)
    type(free_motions_type), intent(in) :: motions
    real(DP) :: z(N, motions%n)
    integer :: m
    do m = 1, motions%n
      z(:, m) = motion_of(motions, m)
    end do
  end function columns


  !> The largest force that K opposes to a kept motion, over the motion.
  real(DP) function largest_force(motions)
    type(free_motions_type), intent(in) :: motions
    real(DP) :: force(N)
    integer :: m
    largest_force = 0.0_DP
    do m = 1, motions%n
      call multiply_symmetric(K, motion_of(motions, m), force)
      largest_force = max(largest_force, maxval(abs(force)) / maxval(abs(motion_of(motions, m))))
    end do
  end function largest_force


  !> Free bodies have six motions each, which K does not oppose; a body held at three nodes has none.
  subroutine check_supports()
    type(free_motions_type) :: motions
    real(DP), allocatable :: z(:, :)
    integer :: i
    integer, allocatable :: none(:)
    allocate (none(0))
    call motions_of(none, motions)
    call suite%that('two free bodies: twelve motions', motions%n == 12)
    call suite%that('without energy', largest_force(motions) < 1.0e-13_DP)
    z = columns(motions)
    call suite%that('of one body each', all(abs(z(:12, 7:)) <= 0.0_DP) .and. all(abs(z(13:, :6)) <= 0.0_DP))
    call motions_of([(i, i=1, 9)], motions)
    call suite%that('one of them held: six', motions%n == 6)
    z = columns(motions)
    call suite%that('of the other', all(abs(z(:12, :)) <= 0.0_DP))
    call motions_of([(i, i=1, N)], motions)
    call suite%that('all held: none', motions%n == 0)
  end subroutine check_supports


  !> Nodes 1 and 5 have the same displacement by rows of the base: one body, with six motions in all.
  subroutine check_coupled_bodies()
    type(free_motions_type) :: motions
    type(constraint_row_type) :: row(3)
    real(DP), allocatable :: z(:, :)
    integer, allocatable :: none(:)
    integer :: i
    allocate (none(0))
    do i = 1, 3
      row(i)%unknown = [12 + i, i]
      row(i)%coefficient = [1.0_DP, -1.0_DP]
    end do
    call motions_of(none, motions, row)
    call suite%that('bodies coupled by rows are one body', motions%n >= 3 .and. motions%n <= 6)
    z = columns(motions)
    call suite%that('its motions obey the rows', all(abs(z(13:15, :) - z(1:3, :)) < 1.0e-14_DP))
  end subroutine check_coupled_bodies


  !> A body held at one node turns about it, held at two nodes about their line.
  subroutine check_hinge()
    type(free_motions_type) :: motions
    real(DP), allocatable :: z(:, :)
    integer :: i
    call motions_of([[(i, i=1, 3)], [(i, i=13, 21)]], motions)
    call suite%that('held at a node: three rotations about it', motions%n == 3)
    call suite%that('without energy', largest_force(motions) < 1.0e-13_DP)
    z = columns(motions)
    call suite%that('and none of the held body', all(abs(z(13:21, :)) <= 0.0_DP))
    call suite%that('the node stays', all(abs(z(1:3, :)) <= 0.0_DP))
    call motions_of([[(i, i=1, 6)], [(i, i=13, 21)]], motions)
    call suite%that('held at two nodes: one rotation', motions%n == 1)
    call suite%that('without energy, too', largest_force(motions) < 1.0e-13_DP)
  end subroutine check_hinge


  !> J Z y = 0 for some y is found also where no column of J Z is zero; a weak spring in each motion is enough against it.
  subroutine check_singularity()
    real(DP) :: images(6, 2), scales(6, 2)
    scales(:, 1) = [1.0_DP, 2.0_DP, -1.0_DP, 0.5_DP, 1.0_DP, 0.0_DP]
    scales(:, 2) = [0.0_DP, 1.0_DP, 1.0_DP, 1.0_DP, -2.0_DP, 1.0_DP]
    images(:, 1) = [1.0_DP, 0.0_DP, 3.0_DP, 0.0_DP, 0.0_DP, 1.0_DP]
    images(:, 2) = -2.0_DP * images(:, 1)
    call suite%that('a combination without force', is_singular(images, scales))
    images(4, 2) = 1.0e-4_DP
    call suite%that('a weak spring', .not. is_singular(images, scales))
    images(4, 2) = 1.0e-14_DP
    call suite%that('a force of rounding', is_singular(images, scales))
    images = 0.0_DP
    call suite%that('no force at all', is_singular(images, scales))
    call suite%that('no motions', .not. is_singular(images(:, :0), scales(:, :0)))
    call suite%that('a motion without scale is not judged', .not. is_singular(images, 0.0_DP * scales))
    scales(:, 2) = 0.0_DP
    call suite%that('but the others are', is_singular(images, scales))
  end subroutine check_singularity


  !> Whether a tangent with these products is singular.
  logical function is_singular(images, scales)
    real(DP), intent(in) :: images(:, :), scales(:, :)
    integer :: m
    is_singular = is_singular_along(size(images, 1), [(compressed(images(:, m)), m=1, size(images, 2))], &
      [(compressed(scales(:, m)), m=1, size(scales, 2))], FREE_RATIO)
  end function is_singular


  !> Free bodies are found, and the least proximal shift makes them regular.
  subroutine check_proximal_shift()
    type(globalization_controls_type), parameter :: LIMITS = globalization_controls_type()
    type(free_motions_type) :: motions
    real(DP), allocatable :: z(:, :), images(:, :), scales(:, :)
    integer, allocatable :: none(:)
    integer :: i, m
    allocate (none(0))
    call motions_of(none, motions)
    z = columns(motions)
    allocate (images, scales, mold=z)
    do m = 1, motions%n
      call multiply_symmetric(K, z(:, m), images(:, m))
      do i = 1, N
        scales(i, m) = K%value(K%first(i)) * z(i, m)
      end do
    end do
    call suite%that('free bodies', is_singular(images, scales))
    call suite%that('one of them', is_singular(images(:, 7:), scales(:, 7:)))
    call suite%that('with the least shift they are held', .not. is_singular(images + LIMITS%min_proximal_shift * scales, scales))
    images(:, 7:) = images(:, 7:) + LIMITS%min_proximal_shift * scales(:, 7:)
    call suite%that('one free and one with the least shift', is_singular(images, scales))
  end subroutine check_proximal_shift

end program test_free_rigid_motions
