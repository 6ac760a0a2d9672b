!> Interpolation of the unknowns of mid-side nodes from those of corners, and the matrix of the corners alone.
!! SPDX-License-Identifier: GPL-3.0-or-later
!!
!! The rows of P are those of the identity for unknowns of corners, and the mean of both ends for those in the middle of an edge. So
!! the columns of P are the shape functions of the linear elements with the same corners, and P'AP is their stiffness matrix,
!! integrated at the points of the quadratic elements.
!! Reference: Ronquist and Patera, J. Sci. Comput. 2 (1987) 389 (coarsening by the order of the elements).
module amontons_midside_interpolation
  use amontons_kinds, only: DP
  use amontons_errors, only: error_type
  use amontons_sparse, only: sparse_type, sparse_from_triplets, sparse_transpose
  implicit none
  private
  public :: build_midside_interpolation, project_to_corners

contains

  !> P from the ends of the edges. An end that is fixed or depends on others contributes nothing.
  subroutine build_midside_interpolation(ends, interpolation)
    integer, intent(in) :: ends(:, :)              !< (2, n) unknowns at the ends of the edge; 0: not free; [i, i]: a corner
    type(sparse_type), intent(out) :: interpolation   !< P (n x unknowns of corners)
    integer :: corner(size(ends, 2)), i, k, n, n_corners
    n = size(ends, 2)
    corner = 0
    n_corners = 0
    do i = 1, n
      if (ends(1, i) /= i) cycle
      n_corners = n_corners + 1
      corner(i) = n_corners
    end do
    interpolation%n_rows = n
    interpolation%n_columns = n_corners
    allocate (interpolation%first(n + 1), interpolation%column(2 * n), interpolation%value(2 * n))
    k = 0
    do i = 1, n
      interpolation%first(i) = k + 1
      if (corner(i) > 0) then
        call append(corner(i), 1.0_DP)
      else
        call append_end(minval(ends(:, i)))
        call append_end(maxval(ends(:, i)))
      end if
    end do
    interpolation%first(n + 1) = k + 1
    interpolation%column = interpolation%column(:k)
    interpolation%value = interpolation%value(:k)

  contains

    !> Appends half of an end, if that is free.
    subroutine append_end(unknown)
      integer, intent(in) :: unknown               !< 0: not free
      if (unknown > 0) call append(corner(unknown), 0.5_DP)
    end subroutine append_end

    !> Appends an entry to the present row.
    subroutine append(column, value)
      integer, intent(in) :: column
      real(DP), intent(in) :: value
      k = k + 1
      interpolation%column(k) = column
      interpolation%value(k) = value
    end subroutine append

  end subroutine build_midside_interpolation


  !> P'AP, upper triangle. W = P'BP, where B is the upper triangle of A with half of its diagonal, gives P'AP = W + W'. W is summed
  !! row by row. Cost: four products for each entry of A between two mid-side unknowns.
  subroutine project_to_corners(interpolation, matrix, coarse, error)
    type(sparse_type), intent(in) :: interpolation !< P
    type(sparse_type), intent(in) :: matrix        !< A: symmetric, upper triangle with its diagonal
    type(sparse_type), intent(out) :: coarse
    type(error_type), allocatable, intent(out) :: error
    type(sparse_type) :: members
    integer, allocatable :: row(:), column(:)
    real(DP), allocatable :: value(:)
    real(DP) :: sum(interpolation%n_columns)       ! row a of W
    integer :: mark(interpolation%n_columns)       ! a for its columns
    integer :: touched(interpolation%n_columns)    ! its columns
    integer :: a, k, n, n_touched
    members = sparse_transpose(interpolation)
    allocate (row(0), column(0), value(0))
    mark = 0
    n = 0
    do a = 1, members%n_rows
      n_touched = 0
      do k = members%first(a), members%first(a + 1) - 1
        call add_row(members%column(k), members%value(k))
      end do
      call reserve(n + n_touched)
      do k = 1, n_touched
        row(n + k) = min(a, touched(k))
        column(n + k) = max(a, touched(k))
        value(n + k) = merge(2.0_DP, 1.0_DP, touched(k) == a) * sum(touched(k))
      end do
      n = n + n_touched
    end do
    call sparse_from_triplets(members%n_rows, members%n_rows, row(:n), column(:n), value(:n), coarse, error)

  contains

    !> Adds a multiple of row i of BP to row a.
    subroutine add_row(i, weight)
      integer, intent(in) :: i
      real(DP), intent(in) :: weight               !< P_ia
      real(DP) :: entry
      integer :: p, q
      do p = matrix%first(i), matrix%first(i + 1) - 1
        entry = weight * matrix%value(p)
        if (matrix%column(p) == i) entry = 0.5_DP * entry
        do q = interpolation%first(matrix%column(p)), interpolation%first(matrix%column(p) + 1) - 1
          associate (b => interpolation%column(q))
            if (mark(b) /= a) then
              mark(b) = a
              sum(b) = 0
              n_touched = n_touched + 1
              touched(n_touched) = b
            end if
            sum(b) = sum(b) + entry * interpolation%value(q)
          end associate
        end do
      end do
    end subroutine add_row

    !> Enlarges the arrays of the triplets.
    subroutine reserve(n_needed)
      integer, intent(in) :: n_needed
      integer :: n_more
      if (n_needed <= size(row)) return
      n_more = n_needed + n_needed / 2 - size(row)
      row = [row, spread(0, 1, n_more)]
      column = [column, spread(0, 1, n_more)]
      value = [value, spread(0.0_DP, 1, n_more)]
    end subroutine reserve

  end subroutine project_to_corners

end module amontons_midside_interpolation
