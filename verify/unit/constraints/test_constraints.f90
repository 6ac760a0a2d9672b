!> Tests of the elimination: rows with common unknowns, chains, conflicts, and condensed forces.
!! SPDX-License-Identifier: GPL-3.0-or-later
program test_constraints
  use amontons_kinds, only: DP
  use amontons_constraints, only: constraints_type, constraint_row_type, reset_constraints, prescribe_unknown, &
    add_constraint_row, eliminate_constraints, &
    scale_offsets, condense_forces, is_prescribed_along, ROW_ACCEPTED, ROW_REDUNDANT, ROW_CONFLICT
  use amontons_sparse, only: multiply, multiply_transpose
  use check, only: suite_type
  implicit none
  type(suite_type) :: suite
  call check_chain()
  call check_verdicts()
  call check_pivot()
  call check_portions()
  call check_prescribed_directions()
  call suite%finish()

contains

  pure function row_of(unknown, coefficient, rhs) result(row)
    integer, intent(in) :: unknown(:)
    real(DP), intent(in) :: coefficient(:), rhs
    type(constraint_row_type) :: row
    row%unknown = unknown
    row%coefficient = coefficient
    row%rhs = rhs
  end function row_of


  !> Node 1 is held across an inclined plane, node 2 follows a node that is held along z, node 3 follows that node turned by 90
  !! degrees; a node with a tiny lever of a free unknown is not held.
  subroutine check_prescribed_directions()
    type(constraints_type) :: c
    real(DP), parameter :: ACROSS(3) = [0.6_DP, 0.8_DP, 0.0_DP], ALONG(3) = [-0.8_DP, 0.6_DP, 0.0_DP], LEVER = 1.0e-9_DP
    real(DP), parameter :: X(3) = [1.0_DP, 0.0_DP, 0.0_DP], Y(3) = [0.0_DP, 1.0_DP, 0.0_DP], Z(3) = [0.0_DP, 0.0_DP, 1.0_DP]
    integer :: k, verdict
    call reset_constraints(c, 15)
    call prescribe_unknown(c, 12, 0.5_DP)
    call prescribe_unknown(c, 14, 0.0_DP)
    call prescribe_unknown(c, 15, 0.0_DP)
    call add_constraint_row(c, row_of([1, 2, 3], ACROSS, 0.1_DP), 3, 1.0e-9_DP, verdict)
    do k = 1, 3
      call add_constraint_row(c, row_of([3 + k, 9 + k], [1.0_DP, -1.0_DP], 0.0_DP), 1, 1.0e-9_DP, verdict)
    end do
    call add_constraint_row(c, row_of([7, 12], [1.0_DP, -1.0_DP], 0.0_DP), 1, 1.0e-9_DP, verdict)
    call add_constraint_row(c, row_of([8, 10], [1.0_DP, -LEVER], 0.0_DP), 1, 1.0e-9_DP, verdict)
    call eliminate_constraints(c)
    call suite%that('across the plane', is_prescribed_along(c, 1, ACROSS) .and. is_prescribed_along(c, 1, -ACROSS))
    call suite%that('along the plane', .not. (is_prescribed_along(c, 1, ALONG) .or. is_prescribed_along(c, 1, X) .or. &
      is_prescribed_along(c, 1, Z)))
    call suite%that('as the node that it follows', is_prescribed_along(c, 2, Z) .and. .not. is_prescribed_along(c, 2, X))
    call suite%that('by an unknown that is prescribed', is_prescribed_along(c, 3, X))
    call suite%that('by a free unknown, whatever its unit', .not. is_prescribed_along(c, 3, Y))
    call suite%that('free', .not. any([is_prescribed_along(c, 3, Z), is_prescribed_along(c, 4, X), is_prescribed_along(c, 5, X)]))
    call suite%that('supports', is_prescribed_along(c, 4, Z) .and. is_prescribed_along(c, 5, Y) .and. &
      is_prescribed_along(c, 5, [1.0e-12_DP, 0.6_DP, 0.8_DP]))
  end subroutine check_prescribed_directions


  !> Every row must hold for any values of the free unknowns, though its unknowns became dependent later.
  subroutine check_chain()
    type(constraints_type) :: c
    type(constraint_row_type) :: rows(4)
    real(DP) :: v(9), du(9), f(3, 3), condensed(3, 3), g(9)
    integer :: i, verdict
    rows(1) = row_of([1, 2, 3], [2.0_DP, -1.0_DP, 0.5_DP], 0.3_DP)
    rows(2) = row_of([2, 4, 5], [1.0_DP, 1.0_DP, -3.0_DP], -0.1_DP)      ! makes 2 dependent, which row 1 uses
    rows(3) = row_of([4, 9, 8], [1.0_DP, 4.0_DP, 1.0_DP], 0.0_DP)        ! makes 4 dependent, which row 2 uses; 8 is fixed
    rows(4) = row_of([1, 6], [1.0_DP, 1.0_DP], 0.7_DP)                   ! its first unknown is dependent already
    call reset_constraints(c, 9)
    call prescribe_unknown(c, 8, 0.25_DP)
    do i = 1, 4
      call add_constraint_row(c, rows(i), 1, 1.0e-12_DP, verdict)
      call suite%that('a row is accepted', verdict == ROW_ACCEPTED)
    end do
    call eliminate_constraints(c)
    call suite%that('9 unknowns less 1 fixed and 4 dependent', c%n_free == 4)
    v = [(0.1_DP * real(i, DP)**2 - 0.4_DP, i=1, 9)]
    call multiply(c%transformation, v(:c%n_free), du)
    du = du + c%offset
    do i = 1, 4
      call suite%near('a row holds', dot_product(rows(i)%coefficient, du(rows(i)%unknown)), rows(i)%rhs, 1.0e-14_DP)
    end do
    call suite%near('the fixed unknown', du(8), 0.25_DP, 0.0_DP)
    f = reshape([(sin(real(i, DP)), i=1, 9)], [3, 3])
    call condense_forces(c, f, condensed)
    call multiply_transpose(c%transformation, reshape(f, [9]), g(:c%n_free))
    do i = 1, 9
      if (c%owner(i) == 0) then
        call suite%near('condensed force is C'' f', condensed(mod(i - 1, 3) + 1, (i + 2) / 3), g(c%free_of(i)), 1.0e-14_DP)
      else
        call suite%near('no force on what is not free', condensed(mod(i - 1, 3) + 1, (i + 2) / 3), 0.0_DP, 0.0_DP)
      end if
    end do
  end subroutine check_chain


  subroutine check_verdicts()
    type(constraints_type) :: c
    integer :: verdict
    call reset_constraints(c, 3)
    call prescribe_unknown(c, 1, 1.0_DP)
    call prescribe_unknown(c, 2, 2.0_DP)
    call add_constraint_row(c, row_of([1, 2], [1.0_DP, 1.0_DP], 3.0_DP), 1, 1.0e-9_DP, verdict)
    call suite%that('said already: redundant', verdict == ROW_REDUNDANT)
    call add_constraint_row(c, row_of([1, 2], [1.0_DP, 1.0_DP], 3.1_DP), 1, 1.0e-9_DP, verdict)
    call suite%that('said otherwise: conflict', verdict == ROW_CONFLICT)
    call add_constraint_row(c, row_of([3, 1], [1.0_DP, -1.0_DP], 0.0_DP), 1, 1.0e-9_DP, verdict)
    call suite%that('a new row', verdict == ROW_ACCEPTED)
    call add_constraint_row(c, row_of([3, 2], [2.0_DP, 1.0_DP], 0.0_DP), 1, 1.0e-9_DP, verdict)
    call suite%that('against a dependent unknown: conflict', verdict == ROW_CONFLICT)
    call eliminate_constraints(c)
    call suite%that('nothing is left', c%n_free == 0)
    call suite%near('the dependent unknown', c%offset(3), 1.0_DP, 1.0e-15_DP)
  end subroutine check_verdicts


  !> The pivot is the largest of the candidates; others are taken only if none of these is left.
  subroutine check_pivot()
    real(DP), parameter :: UNITS(3) = [1.0_DP, 1000.0_DP, 39.37_DP]
    type(constraints_type) :: c
    integer :: verdict, i
    call reset_constraints(c, 6)
    call add_constraint_row(c, row_of([1, 2, 3, 4], [0.3_DP, -0.8_DP, 0.5_DP, 5.0_DP], 0.0_DP), 3, 0.0_DP, verdict)
    call suite%that('pivot 2', c%owner(2) > 0)
    call reset_constraints(c, 6)
    call prescribe_unknown(c, 1, 0.0_DP)
    call add_constraint_row(c, row_of([1, 5, 6], [1.0_DP, -0.4_DP, -0.6_DP], 0.1_DP), 1, 0.0_DP, verdict)
    call suite%that('pivot 6, since 1 is fixed', c%owner(6) > 0)
    do i = 1, 3                                    ! node 2 has rotations: the arm of 0.05 m, of 50 mm, of 2 inch
      associate (arm => 0.05_DP * UNITS(i))
        call reset_constraints(c, 6, [1.0_DP, 0.2_DP * arm])
        call add_constraint_row(c, row_of([1, 2, 4], [1.0_DP, -0.6_DP, -arm], 0.0_DP), 3, 0.0_DP, verdict)
        call suite%that('the rotation, in any unit', c%owner(4) > 0)
        call reset_constraints(c, 6, [1.0_DP, 5.0_DP * arm])
        call add_constraint_row(c, row_of([1, 2, 4], [1.0_DP, -0.6_DP, -arm], 0.0_DP), 3, 0.0_DP, verdict)
        call suite%that('the displacement beside a short arm, in any unit', c%owner(1) > 0)
      end associate
    end do
  end subroutine check_pivot


  !> A fraction of all prescribed amounts: rows hold with that fraction of their right-hand sides, C is the same.
  subroutine check_portions()
    type(constraints_type) :: whole, part
    type(constraint_row_type) :: rows(3)
    real(DP) :: v(8), du(8), part_du(8)
    integer :: i, verdict
    rows(1) = row_of([1, 2, 8], [2.0_DP, -1.0_DP, 0.5_DP], 0.3_DP)       ! 8 is fixed
    rows(2) = row_of([2, 4, 5], [1.0_DP, 1.0_DP, -3.0_DP], -0.1_DP)      ! makes 2 dependent, which row 1 uses
    rows(3) = row_of([5, 6], [1.0_DP, 1.0_DP], 0.7_DP)                   ! added when the first two have been scaled
    call reset_constraints(whole, 8)
    call prescribe_unknown(whole, 8, 0.25_DP)
    do i = 1, 2
      call add_constraint_row(whole, rows(i), 1, 1.0e-12_DP, verdict)
    end do
    call eliminate_constraints(whole)
    part = whole
    call scale_offsets(part, 0.375_DP)
    v = [(0.1_DP * real(i, DP)**2 - 0.4_DP, i=1, 8)]
    call multiply(whole%transformation, v(:whole%n_free), du)
    call multiply(part%transformation, v(:part%n_free), part_du)
    call suite%near('C is the same', maxval(abs(part_du - du)), 0.0_DP, 0.0_DP)
    call suite%near('c is a part', maxval(abs(part%offset - 0.375_DP * whole%offset)), 0.0_DP, 0.0_DP)
    call add_constraint_row(part, rows(3), 1, 1.0e-12_DP, verdict)
    call eliminate_constraints(part)
    call multiply(part%transformation, v(:part%n_free), du)
    du = du + part%offset
    call suite%near('a part of the fixed amount', du(8), 0.375_DP * 0.25_DP, 0.0_DP)
    do i = 1, 2
      call suite%near('a row holds in part', dot_product(rows(i)%coefficient, du(rows(i)%unknown)), 0.375_DP * rows(i)%rhs, &
        1.0e-14_DP)
    end do
    call suite%near('a row that came later holds in whole', dot_product(rows(3)%coefficient, du(rows(3)%unknown)), rows(3)%rhs, &
      1.0e-14_DP)
  end subroutine check_portions

end program test_constraints
