!> Tests of joined bodies: rows with known motions, joints of full and of lower rank, loops, and knots of three nodes.
!! SPDX-License-Identifier: GPL-3.0-or-later
program test_joined_bodies
  use amontons_kinds, only: DP
  use amontons_joined_bodies, only: joined_bodies_type, join_bodies, join_vectors
  use check, only: suite_type
  implicit none
  integer, parameter :: N_BODIES = 60
  type(suite_type) :: suite
  call check_chain(suite, 6, .false., 6)
  call check_chain(suite, 6, .true., 6)
  call check_chain(suite, 5, .false., 7)
  call check_support(suite)
  call check_knots(suite)
  call suite%finish()

contains

  !> A well-conditioned matrix of a body: all move as one if the motions of each are this matrix times the same six numbers.
  pure function matrix_of(b) result(G)
    integer, intent(in) :: b
    real(DP) :: G(6, 6)
    integer :: i, j
    do j = 1, 6
      do i = 1, 6
        G(i, j) = 0.2_DP * sin(real(7 * i + 13 * j + 29 * b, DP))
      end do
      G(j, j) = G(j, j) + 1.0_DP + 0.1_DP * real(mod(b, 5), DP)
    end do
  end function matrix_of


  !> Appends rows that vanish where two bodies move as one: values M with M G_a m - M_b G_b m = 0.
  subroutine add_joint(a, b, n_rows, first, column, value)
    integer, intent(in) :: a, b, n_rows
    integer, allocatable, intent(inout) :: first(:), column(:)
    real(DP), allocatable, intent(inout) :: value(:)
    real(DP) :: row_a(6), row_b(6), G(6, 6)
    integer :: k, i, j, p
    real(DP) :: x(6, 6), factor
    ! x = G_a inv(G_b): with m_b = G_b m it is m_a = x m_b
    x = transpose(matrix_of(a))
    G = transpose(matrix_of(b))
    do p = 1, 6                                    ! Gauss elimination; the diagonal dominates
      do i = 1, 6
        if (i == p) cycle
        factor = G(i, p) / G(p, p)
        G(i, :) = G(i, :) - factor * G(p, :)
        x(i, :) = x(i, :) - factor * x(p, :)
      end do
    end do
    do p = 1, 6
      x(p, :) = x(p, :) / G(p, p)
    end do
    x = transpose(x)
    do k = 1, n_rows
      row_a = [(cos(real(3 * k * j + k, DP)), j=1, 6)]
      row_b = -matmul(row_a, x)
      column = [column, [(6 * (a - 1) + j, j=1, 6)], [(6 * (b - 1) + j, j=1, 6)]]
      value = [value, row_a, row_b]
      first = [first, size(column) + 1]
    end do
  end subroutine add_joint


  !> The largest value of rows times vectors.
  pure real(DP) function residual(first, column, value, vectors)
    integer, intent(in) :: first(:), column(:)
    real(DP), intent(in) :: value(:), vectors(:, :)
    integer :: r, v
    residual = 0.0_DP
    do v = 1, size(vectors, 2)
      do r = 1, size(first) - 1
        residual = max(residual, abs(dot_product(value(first(r):first(r + 1) - 1), vectors(column(first(r):first(r + 1) - 1), v))))
      end do
    end do
  end function residual


  !> A chain of bodies, perhaps with loops; one joint may have fewer rows than motions. What is left are the motions of the roots.
  subroutine check_chain(suite, n_rows, has_loops, n_expected)
    type(suite_type), intent(inout) :: suite
    integer, intent(in) :: n_rows                  !< of the joint in the middle
    logical, intent(in) :: has_loops
    integer, intent(in) :: n_expected              !< free motions
    type(joined_bodies_type) :: joined
    integer, allocatable :: first(:), column(:), first_left(:), column_left(:)
    real(DP), allocatable :: value(:), value_left(:), of_roots(:, :), vectors(:, :)
    integer :: b, i, m
    first = [1]
    allocate (column(0), value(0))
    do b = 1, N_BODIES - 1
      call add_joint(b, b + 1, merge(n_rows, 7, b == N_BODIES / 2), first, column, value)
    end do
    if (has_loops) then
      do b = 1, N_BODIES - 10, 7
        call add_joint(b + 9, b, 6, first, column, value)
      end do
    end if
    first_left = first
    column_left = column
    value_left = value
    call join_bodies([(6, b=1, N_BODIES)], first_left, column_left, value_left, joined)
    m = joined%first_of_root(size(joined%n) + 1) - 1
    call suite%that('chain: one body is left, or two at a weak joint', m == merge(6, 12, n_rows == 6))
    call suite%that('chain: rows are left at a weak joint alone', size(column_left) == merge(0, 12 * n_rows, n_rows == 6))
    if (n_rows < 6) then
      call suite%that('chain: a weak joint has its rows', n_expected == m - n_rows)
      return
    end if
    allocate (of_roots(m, m), source=0.0_DP)
    allocate (vectors(6 * N_BODIES, m))
    do i = 1, m
      of_roots(i, i) = 1.0_DP
    end do
    call join_vectors(joined, of_roots, vectors)
    call suite%near('chain: the motions fulfil all rows', residual(first, column, value, vectors), 0.0_DP, 1.0e-10_DP)
    call suite%that('chain: no motion is lost', m == n_expected)
  end subroutine check_chain


  !> Rows of one body stay: a held chain keeps six rows on one root.
  subroutine check_support(suite)
    type(suite_type), intent(inout) :: suite
    type(joined_bodies_type) :: joined
    integer, allocatable :: first(:), column(:)
    real(DP), allocatable :: value(:)
    integer :: b, i
    first = [1]
    allocate (column(0), value(0))
    do b = 1, N_BODIES - 1
      call add_joint(b, b + 1, 6, first, column, value)
    end do
    do i = 1, 6
      column = [column, 6 + i]
      value = [value, 1.0_DP]
      first = [first, size(column) + 1]
    end do
    call join_bodies([(6, b=1, N_BODIES)], first, column, value, joined)
    call suite%that('support: one root', joined%first_of_root(size(joined%n) + 1) - 1 == 6)
    call suite%that('support: its rows have entries of all motions', size(column) >= 6 .and. maxval(column) <= 6)
  end subroutine check_support


  !> Displacements, rotations and a stretch in one row are one body of seven motions; so a bar of six follows its knot.
  subroutine check_knots(suite)
    type(suite_type), intent(inout) :: suite
    type(joined_bodies_type) :: joined
    integer, allocatable :: first(:), column(:)
    real(DP), allocatable :: value(:), vectors(:, :)
    real(DP) :: of_roots(7, 7)
    integer :: i, j
    first = [1]
    allocate (column(0), value(0))
    do i = 1, 7                                    ! bar 1 to 6, knot 7 to 13
      column = [column, [(j, j=1, 13)]]
      value = [value, [(cos(real(3 * i * j, DP)), j=1, 6)], [(sin(real(2 * i * j, DP)), j=1, 7)]]
      first = [first, size(column) + 1]
    end do
    associate (given_first => first, given_column => column, given_value => value)
      call join_copy(given_first, given_column, given_value, joined)
    end associate
    call suite%that('knot: two bodies', size(joined%n) == 2 .and. all(joined%n == [6, 7]))
    call suite%that('knot: the bar follows it', joined%first_of_root(3) - 1 == 7)
    of_roots = 0.0_DP
    do i = 1, 7
      of_roots(i, i) = 1.0_DP
    end do
    allocate (vectors(13, 7))
    call join_vectors(joined, of_roots, vectors)
    call suite%near('knot: it moves as its own motions', maxval(abs(vectors(7:13, :) - of_roots)), 0.0_DP, 1.0e-14_DP)
  end subroutine check_knots


  !> Joins a bar of six motions and nodes of three, three and one.
  subroutine join_copy(first, column, value, joined)
    integer, intent(in) :: first(:), column(:)
    real(DP), intent(in) :: value(:)
    type(joined_bodies_type), intent(out) :: joined
    integer, allocatable :: first_left(:), column_left(:)
    real(DP), allocatable :: value_left(:)
    first_left = first
    column_left = column
    value_left = value
    call join_bodies([6, 3, 3, 1], first_left, column_left, value_left, joined)
  end subroutine join_copy

end program test_joined_bodies
