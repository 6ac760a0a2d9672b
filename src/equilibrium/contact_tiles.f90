!> Tiles of the contact skin: the dense LU factor of the tangent on each of its small patches.
!! SPDX-License-Identifier: GPL-3.0-or-later
!!
!! Theory: doc/theory/solver.md, "The contact skin". The tangent on the unknowns F of a tile is
!!
!!     J_FF = T_F' ((1 + D_R) K - D_u) T_F,
!!
!! with T the transformation from the free unknowns to all unknowns of the skin, and K, D_R and D_u on the skin. The factors only
!! precondition, so that single precision suffices.
module amontons_contact_tiles
  use amontons_kinds, only: DP, SP
  use amontons_errors, only: error_type, set_error, EXIT_SOLVER
  use amontons_sparse, only: sparse_type
  use amontons_blas_lapack, only: sgetrf, sgetrs
  implicit none
  private
  public :: tangent_parts_type, tile_type, factorise_tiles, correct_tiles

  !> The parts of the tangent on the skin. n_skin: unknowns of the skin; n_free: free unknowns among them.
  type :: tangent_parts_type
    type(sparse_type) :: relation                  !< T (n_skin x n_free)
    type(sparse_type) :: relation_t                !< T'
    type(sparse_type) :: stiffness                 !< K, both triangles (n_skin x n_skin) [force/length]
    type(sparse_type) :: by_imbalance_t            !< D_R' (n_skin x n_skin) [-]
    type(sparse_type) :: by_displacement_t         !< D_u' (n_skin x n_skin) [force/length]
  end type tangent_parts_type

  !> One tile.
  type :: tile_type
    integer, allocatable :: member(:)              !< free unknowns of the skin
    real(SP), allocatable :: lu(:, :)              !< LU factors of J_FF
    integer, allocatable :: pivots(:)
    logical :: is_ready = .false.                  !< .false.: J_FF is singular, the tile is skipped
  end type tile_type

  !> A sparse vector over the unknowns of the skin: values and indices of the nonzero entries.
  type :: spike_type
    real(DP), allocatable :: value(:)              !< (n_skin)
    logical, allocatable :: is_there(:)            !< (n_skin)
    integer, allocatable :: at(:)                  !< (n_skin) the first n are used
    integer :: n = 0
  end type spike_type

contains

  !> Factorises the tangent on each tile. The threads share the tiles; the result does not depend on their number.
  subroutine factorise_tiles(parts, tiles, error)
    type(tangent_parts_type), intent(in) :: parts
    type(tile_type), intent(inout) :: tiles(:)     !< with their members
    type(error_type), allocatable, intent(out) :: error
    integer :: n_failed
    n_failed = 0
    !$omp parallel reduction(+:n_failed)
    call factorise_share(parts, tiles, n_failed)
    !$omp end parallel
    if (n_failed > 0) call set_error(error, EXIT_SOLVER, 'Not enough memory for the tiles of the contact skin.')
  end subroutine factorise_tiles


  !> One thread's share of the tiles. (A procedure: gfortran 12 frees no allocatable variable of a block within a parallel region.)
  subroutine factorise_share(parts, tiles, n_failed)
    type(tangent_parts_type), intent(in) :: parts
    type(tile_type), intent(inout) :: tiles(:)     !< with their members
    integer, intent(inout) :: n_failed             !< tiles whose allocation failed
    type(spike_type) :: y, z
    integer, allocatable :: place(:)
    integer :: t
    allocate (place(parts%relation%n_columns), source=0)
    call clear_spike(parts%relation%n_rows, y)
    call clear_spike(parts%relation%n_rows, z)
    !$omp do schedule(dynamic)
    do t = 1, size(tiles)
      call factorise_tile(parts, place, y, z, tiles(t), n_failed)
    end do
    !$omp end do
  end subroutine factorise_share


  !> An empty sparse vector.
  pure subroutine clear_spike(n, spike)
    integer, intent(in) :: n
    type(spike_type), intent(out) :: spike
    allocate (spike%value(n), source=0.0_DP)
    allocate (spike%is_there(n), source=.false.)
    allocate (spike%at(n))
  end subroutine clear_spike


  !> The tangent on one tile and its factor.
  subroutine factorise_tile(parts, place, y, z, tile, n_failed)
    type(tangent_parts_type), intent(in) :: parts
    integer, intent(inout) :: place(:)             !< (n_free) 0 between calls
    type(spike_type), intent(inout) :: y, z        !< empty between calls
    type(tile_type), intent(inout) :: tile
    integer, intent(inout) :: n_failed             !< tiles whose allocation failed
    integer :: n, j, status
    n = size(tile%member)
    tile%is_ready = .false.
    if (allocated(tile%lu)) then
      if (size(tile%pivots) /= n) deallocate (tile%lu, tile%pivots)
    end if
    if (.not. allocated(tile%lu)) then
      allocate (tile%lu(n, n), stat=status)
      if (status /= 0) n_failed = n_failed + 1
      if (status /= 0) return
      allocate (tile%pivots(n))
    end if
    place(tile%member) = [(j, j=1, n)]
    tile%lu = 0.0_SP
    do j = 1, n
      call fill_column(parts, tile%member(j), place, y, z, tile%lu(:, j))
    end do
    place(tile%member) = 0
    if (n == 0) return
    call sgetrf(n, n, tile%lu, n, tile%pivots, status)
    tile%is_ready = status == 0
  end subroutine factorise_tile


  !> The column of the tangent of a free unknown, restricted to the tile: T_F' ((1 + D_R) K - D_u) T e.
  pure subroutine fill_column(parts, free, place, y, z, column)
    type(tangent_parts_type), intent(in) :: parts
    integer, intent(in) :: free
    integer, intent(in) :: place(:)                !< (n_free) index in the tile; 0: not in it
    type(spike_type), intent(inout) :: y, z        !< empty before and after
    real(SP), intent(inout) :: column(:)
    integer :: p, k, m
    associate (t => parts%relation_t)
      do p = t%first(free), t%first(free + 1) - 1
        call add_row(parts%stiffness, t%column(p), t%value(p), y)
        call add_row(parts%by_displacement_t, t%column(p), -t%value(p), z)
      end do
    end associate
    do k = 1, y%n
      m = y%at(k)
      call add_entry(m, y%value(m), z)
      call add_row(parts%by_imbalance_t, m, y%value(m), z)
      y%value(m) = 0.0_DP
      y%is_there(m) = .false.
    end do
    y%n = 0
    associate (t => parts%relation)
      do k = 1, z%n
        m = z%at(k)
        do p = t%first(m), t%first(m + 1) - 1
          if (place(t%column(p)) > 0) column(place(t%column(p))) = column(place(t%column(p))) + real(t%value(p) * z%value(m), SP)
        end do
        z%value(m) = 0.0_DP
        z%is_there(m) = .false.
      end do
    end associate
    z%n = 0
  end subroutine fill_column


  !> Adds a multiple of a row of a matrix.
  pure subroutine add_row(matrix, row, factor, spike)
    type(sparse_type), intent(in) :: matrix
    integer, intent(in) :: row
    real(DP), intent(in) :: factor
    type(spike_type), intent(inout) :: spike
    integer :: p
    do p = matrix%first(row), matrix%first(row + 1) - 1
      call add_entry(matrix%column(p), factor * matrix%value(p), spike)
    end do
  end subroutine add_row


  !> Adds to one value.
  pure subroutine add_entry(at, amount, spike)
    integer, intent(in) :: at
    real(DP), intent(in) :: amount
    type(spike_type), intent(inout) :: spike
    if (.not. spike%is_there(at)) then
      spike%is_there(at) = .true.
      spike%n = spike%n + 1
      spike%at(spike%n) = at
    end if
    spike%value(at) = spike%value(at) + amount
  end subroutine add_entry


  !> x_F = x_F + inv(J_FF) r_F on all tiles.
  subroutine correct_tiles(tiles, r, x)
    type(tile_type), intent(in) :: tiles(:)
    real(DP), intent(in) :: r(:)                   !< (n_free of the skin) [force]
    real(DP), intent(inout) :: x(:)                !< (n_free of the skin) [length]
    integer :: t
    !$omp parallel do schedule(dynamic)
    do t = 1, size(tiles)
      if (tiles(t)%is_ready) call correct_tile(tiles(t), r, x)
    end do
    !$omp end parallel do
  end subroutine correct_tiles


  !> The correction on one tile.
  subroutine correct_tile(tile, r, x)
    type(tile_type), intent(in) :: tile
    real(DP), intent(in) :: r(:)                   !< [force]
    real(DP), intent(inout) :: x(:)                !< [length]
    real(SP) :: b(size(tile%member), 1)
    real(DP) :: size_of_r
    integer :: n, status
    n = size(tile%member)
    size_of_r = maxval(abs(r(tile%member)))
    if (.not. size_of_r > 0.0_DP) return
    b(:, 1) = real(r(tile%member) / size_of_r, SP)
    call sgetrs('N', n, 1, tile%lu, n, tile%pivots, b, n, status)
    x(tile%member) = x(tile%member) + size_of_r * real(b(:, 1), DP)
  end subroutine correct_tile

end module amontons_contact_tiles
