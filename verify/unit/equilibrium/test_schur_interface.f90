!> Tests of the condensed interface: its inverse against a dense one, with constraints and contact tangents, and its ways out.
!! SPDX-License-Identifier: GPL-3.0-or-later
program test_schur_interface
  use amontons_kinds, only: DP
  use amontons_errors, only: error_type
  use amontons_sparse, only: sparse_type, sparse_from_triplets, full_from_upper, multiply
  use amontons_dense, only: solve_small, DENSE_OK
  use amontons_factorization, only: FACTOR_OK
  use amontons_constraints, only: constraints_type, constraint_row_type, reset_constraints, prescribe_unknown, &
    add_constraint_row, eliminate_constraints
  use amontons_woodbury_interface, only: contact_springs_type
  use amontons_schur_interface, only: schur_interface_type, is_analysis_valid, analyse_bulk, factorise_bulk, factorise_interface, &
    factorise_woodbury, apply_schur_interface
  use check, only: suite_type
  use samples, only: dense_of
  implicit none
  type(suite_type) :: suite
  integer, parameter :: N = 30                     ! unknowns: a chain of 10 nodes
  call check_inverse(suite, .false.)
  call check_inverse(suite, .true.)
  call check_interface_alone(suite)
  call check_incomplete(suite)
  call check_singular(suite)
  call check_springs(suite)
  call check_indefinite(suite)
  call suite%finish()

contains

  !> A positive stiffness: neighbours coupled, each direction with its own springs; upper triangle.
  subroutine make_stiffness(ground, matrix)
    real(DP), intent(in) :: ground                 !< spring of each unknown to the ground [force/length]
    type(sparse_type), intent(out) :: matrix
    type(error_type), allocatable :: error
    integer :: row(2 * N), column(2 * N), i, k
    real(DP) :: value(2 * N)
    k = 0
    do i = 1, N
      k = k + 1
      row(k) = i
      column(k) = i
      value(k) = ground
      if (i > 3) value(k) = value(k) + spring(i - 3)
      if (i + 3 > N) cycle
      value(k) = value(k) + spring(i)
      k = k + 1
      row(k) = i
      column(k) = i + 3
      value(k) = -spring(i)
    end do
    call sparse_from_triplets(N, N, row(:k), column(:k), value(:k), matrix, error)
  end subroutine make_stiffness


  !> The spring from unknown i to i + 3.
  pure real(DP) function spring(i)
    integer, intent(in) :: i
    spring = 2.0_DP + sin(real(i, DP))
  end function spring


  !> The first node is fixed; with rows, unknown 16 depends on 19 and 22, as a contact row does.
  subroutine make_constraints(has_row, constraints)
    logical, intent(in) :: has_row
    type(constraints_type), intent(inout) :: constraints
    type(constraint_row_type) :: row
    integer :: i, status
    call reset_constraints(constraints, N)
    do i = 1, 3
      call prescribe_unknown(constraints, i, 0.0_DP)
    end do
    if (has_row) then
      row%unknown = [16, 19, 22]
      row%coefficient = [1.0_DP, -0.4_DP, -0.6_DP]
      call add_constraint_row(constraints, row, 1, 1.0e-9_DP, status)
    end if
    call eliminate_constraints(constraints)
  end subroutine make_constraints


  !> Tangents of contact between nodes 6, 7 and 8 (unknowns 16 to 24): unsymmetric; zero elsewhere.
  subroutine make_tangents(size_r, size_u, imbalance_tangent, displacement_tangent)
    real(DP), intent(in) :: size_r, size_u         !< of D_R [-] and D_u [force/length]
    type(sparse_type), intent(out) :: imbalance_tangent, displacement_tangent
    type(error_type), allocatable :: error
    integer :: i
    integer, parameter :: ROWS(6) = [16, 17, 18, 19, 22, 24], COLUMNS(6) = [17, 16, 20, 24, 23, 16]
    call sparse_from_triplets(N, N, ROWS, COLUMNS, size_r * [(real(i, DP), i=1, 6)], imbalance_tangent, error)
    call sparse_from_triplets(N, N, ROWS, COLUMNS([6, 5, 4, 3, 2, 1]), size_u * [(real(7 - i, DP), i=1, 6)], &
      displacement_tangent, error)
  end subroutine make_tangents


  !> J = C' ((1 + D_R E) K - D_u) C as a dense matrix, with E = 1 on what is not fixed: there is no row in the base.
  function dense_tangent(stiffness, imbalance_tangent, displacement_tangent, constraints) result(J)
    type(sparse_type), intent(in) :: stiffness, imbalance_tangent, displacement_tangent
    type(constraints_type), intent(in) :: constraints
    real(DP), allocatable :: J(:, :)
    real(DP) :: K(N, N), C(N, constraints%n_free), free(N, N)
    integer :: i
    K = dense_of(full_from_upper(stiffness))
    C = dense_of(constraints%transformation)
    free = 0.0_DP
    do i = 4, N
      free(i, i) = 1.0_DP
    end do
    K = K + matmul(dense_of(imbalance_tangent), matmul(free, K)) - dense_of(displacement_tangent)
    J = matmul(transpose(C), matmul(K, C))
  end function dense_tangent


  !> The unknowns of nodes 5 to 9.
  pure function contact_unknowns() result(is_contact)
    logical :: is_contact(N)
    integer :: i
    is_contact = [(i >= 13 .and. i <= 27, i=1, N)]
  end function contact_unknowns


  !> Analysed and factorised, with the first node fixed.
  subroutine make_bulk(stiffness, condensed, base, status)
    type(sparse_type), intent(in) :: stiffness
    type(schur_interface_type), intent(out) :: condensed
    type(constraints_type), intent(inout) :: base
    integer, intent(out) :: status
    type(error_type), allocatable :: error
    call make_constraints(.false., base)
    call analyse_bulk(condensed, stiffness, base, contact_unknowns(), error)
    if (allocated(error) .or. .not. condensed%is_analysed) error stop 'the analysis'
    call factorise_bulk(condensed, stiffness, base, status, error)
    if (allocated(error)) error stop 'the factor'
  end subroutine make_bulk


  !> x = inv(J) r against the dense solution, with and without a contact row; the factor of the bulk serves both.
  subroutine check_inverse(suite, has_row)
    type(suite_type), intent(inout) :: suite
    logical, intent(in) :: has_row
    type(sparse_type) :: stiffness, d_r, d_u
    type(schur_interface_type) :: condensed
    type(constraints_type) :: base, constraints
    type(error_type), allocatable :: error
    real(DP), allocatable :: r(:), x(:), exact(:)
    integer :: status, i
    logical :: is_complete
    call make_stiffness(0.1_DP, stiffness)
    call make_bulk(stiffness, condensed, base, status)
    call suite%that('the bulk is factorised', status == FACTOR_OK .and. condensed%is_ready .and. condensed%n_contact == 15)
    call suite%that('the analysis holds', is_analysis_valid(condensed, base))
    call make_constraints(has_row, constraints)
    call suite%that('but not for other constraints of the base', is_analysis_valid(condensed, constraints) .neqv. has_row)
    do i = 1, 3
      call make_tangents(0.05_DP * real(i - 1, DP), 0.1_DP * real(i - 1, DP), d_r, d_u)
      call factorise_interface(condensed, base, constraints, d_r, d_u, is_complete, error)
      call suite%that('complete and regular', is_complete .and. .not. condensed%is_singular .and. .not. allocated(error))
      r = [(cos(real(3 * status + i + status, DP)), status=1, constraints%n_free)]
      allocate (x, exact, mold=r)
      call apply_schur_interface(condensed, r, x)
      call solve_small(dense_tangent(stiffness, d_r, d_u, constraints), r, exact, status)
      call suite%that('the dense one is regular', status == DENSE_OK)
      call suite%near('the same solution', maxval(abs(x - exact)), 0.0_DP, 1.0e-11_DP * maxval(abs(exact)))
      deallocate (x, exact)
    end do
  end subroutine check_inverse


  !> A force on the interface alone: the forward solution is left out. A force on the bulk alone counts: it is more than what is
  !! allowed.
  subroutine check_interface_alone(suite)
    type(suite_type), intent(inout) :: suite
    type(sparse_type) :: stiffness, d_r, d_u
    type(schur_interface_type) :: condensed
    type(constraints_type) :: base
    type(error_type), allocatable :: error
    real(DP) :: r(N - 3), x(N - 3), exact(N - 3)
    integer :: status, i
    logical :: is_complete
    call make_stiffness(0.1_DP, stiffness)
    call make_bulk(stiffness, condensed, base, status)
    call make_tangents(0.05_DP, 0.1_DP, d_r, d_u)
    call factorise_interface(condensed, base, base, d_r, d_u, is_complete, error)
    condensed%allowed_residual = 1.0e-6_DP
    do i = 1, 2
      r = 0.0_DP
      if (i == 1) r(16) = 1.0_DP                   ! unknown 19: interface
      if (i == 2) r(2) = 1.0_DP                    ! unknown 5: bulk
      call apply_schur_interface(condensed, r, x)
      call solve_small(dense_tangent(stiffness, d_r, d_u, base), r, exact, status)
      call suite%near('one unit force', maxval(abs(x - exact)), 0.0_DP, 1.0e-12_DP)
    end do
  end subroutine check_interface_alone


  !> A row that reaches beyond the interface: nothing is made of it.
  subroutine check_incomplete(suite)
    type(suite_type), intent(inout) :: suite
    type(sparse_type) :: stiffness, d_r, d_u
    type(schur_interface_type) :: condensed
    type(constraints_type) :: base, constraints
    type(constraint_row_type) :: row
    type(error_type), allocatable :: error
    integer :: status, k
    logical :: is_complete
    call make_stiffness(0.1_DP, stiffness)
    call make_bulk(stiffness, condensed, base, status)
    call make_tangents(0.0_DP, 0.0_DP, d_r, d_u)
    do k = 1, 2
      call reset_constraints(constraints, N)
      call prescribe_unknown(constraints, 1, 0.0_DP)
      call prescribe_unknown(constraints, 2, 0.0_DP)
      call prescribe_unknown(constraints, 3, 0.0_DP)
      row = constraint_row_type()
      row%unknown = merge([16, 10], [10, 16], k == 1)   ! unknown 10 is not on the interface
      row%coefficient = [1.0_DP, -1.0_DP]
      call add_constraint_row(constraints, row, 1, 1.0e-9_DP, status)
      call eliminate_constraints(constraints)
      call factorise_interface(condensed, base, constraints, d_r, d_u, is_complete, error)
      call suite%that('a row beyond the interface', .not. is_complete .and. .not. allocated(error))
    end do
  end subroutine check_incomplete


  !> A contact tangent that takes the stiffness of an unknown away: the interface has no inverse.
  subroutine check_singular(suite)
    type(suite_type), intent(inout) :: suite
    type(sparse_type) :: stiffness, d_r, d_u
    type(schur_interface_type) :: condensed
    type(constraints_type) :: base
    type(error_type), allocatable :: error
    integer :: status, i
    logical :: is_complete
    call make_stiffness(0.1_DP, stiffness)
    call make_bulk(stiffness, condensed, base, status)
    call sparse_from_triplets(N, N, [(i, i=13, 27)], [(i, i=13, 27)], [(-1.0_DP, i=13, 27)], d_r, error)
    call sparse_from_triplets(N, N, [integer ::], [integer ::], [real(DP) ::], d_u, error)
    call factorise_interface(condensed, base, base, d_r, d_u, is_complete, error)
    call suite%that('nothing holds the interface', is_complete .and. condensed%is_singular)
    call make_tangents(0.0_DP, 0.0_DP, d_r, d_u)
    call factorise_interface(condensed, base, base, d_r, d_u, is_complete, error)
    call suite%that('without contact the bulk does', .not. condensed%is_singular)
  end subroutine check_singular


  !> Springs by their products: the same solution as with their matrix in D_u.
  subroutine check_springs(suite)
    type(suite_type), intent(inout) :: suite
    type(sparse_type) :: stiffness, none, d_u
    type(schur_interface_type) :: condensed
    type(constraints_type) :: base
    type(contact_springs_type) :: springs
    type(error_type), allocatable :: error
    real(DP) :: r(N - 3), x(N - 3), exact(N - 3)
    integer :: status, i
    logical :: is_complete, is_fit
    call make_stiffness(0.1_DP, stiffness)
    call make_bulk(stiffness, condensed, base, status)
    call sparse_from_triplets(N, 3, [16, 22, 17, 18], [1, 1, 2, 3], [1.0_DP, -1.0_DP, 1.0_DP, 1.0_DP], &
      springs%force_distribution, error)
    call sparse_from_triplets(3, N, [1, 1, 2, 3], [16, 22, 17, 18], [-3.0_DP, 3.0_DP, -1.0_DP, -2.0_DP], &
      springs%spring_tangent, error)
    call sparse_from_triplets(N, 2, [16], [1], [0.2_DP], springs%distribution_change, error)
    call sparse_from_triplets(2, N, [1], [19], [0.5_DP], springs%projection_gradient, error)
    call sparse_from_triplets(N, N, [16, 16, 22, 22, 17, 18, 16], [16, 22, 16, 22, 17, 18, 19], &
      [-3.0_DP, 3.0_DP, 3.0_DP, -3.0_DP, -1.0_DP, -2.0_DP, 0.1_DP], d_u, error)
    call sparse_from_triplets(N, N, [integer ::], [integer ::], [real(DP) ::], none, error)
    call factorise_woodbury(condensed, base, base, springs, is_complete, is_fit, error)
    call suite%that('springs: fit', is_complete .and. is_fit .and. condensed%is_invertible .and. .not. allocated(error))
    condensed%allowed_residual = 1.0e-9_DP
    r = [(cos(real(i * i, DP)), i=1, N - 3)]
    call apply_schur_interface(condensed, r, x)
    call solve_small(dense_tangent(stiffness, none, d_u, base), r, exact, status)
    call suite%near('springs: the same solution', maxval(abs(x - exact)), 0.0_DP, 1.0e-9_DP * maxval(abs(exact)))
    call factorise_interface(condensed, base, base, none, d_u, is_complete, error)
    call apply_schur_interface(condensed, r, x)
    call suite%near('springs: and as a matrix', maxval(abs(x - exact)), 0.0_DP, 1.0e-11_DP * maxval(abs(exact)))
  end subroutine check_springs


  !> A bulk that is not stable away from the interface has no factor.
  subroutine check_indefinite(suite)
    type(suite_type), intent(inout) :: suite
    type(sparse_type) :: stiffness
    type(schur_interface_type) :: condensed
    type(constraints_type) :: base
    integer :: status
    call make_stiffness(-20.0_DP, stiffness)
    call make_bulk(stiffness, condensed, base, status)
    call suite%that('not stable', status /= FACTOR_OK .and. .not. condensed%is_ready)
  end subroutine check_indefinite

end program test_schur_interface
