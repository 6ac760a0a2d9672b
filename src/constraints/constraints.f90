!> Elimination of linear constraints (master-slave elimination): du = C dv + c, condensed forces, multipliers.
!! SPDX-License-Identifier: GPL-3.0-or-later
!! Each row is an equation sum a_j du_j = b. Rows are added in the order of their priority. A row is reduced by the unknowns that
!! rows of higher priority have made dependent; of the remaining unknowns one, the pivot, becomes dependent on the others. So an
!! expression refers only to unknowns that were free at that time, cycles cannot occur, and the expansion of the expressions from
!! the last to the first gives C and c. See doc/theory/solver.md (the section of amontons_constraints).
module amontons_constraints
  use amontons_kinds, only: DP
  use amontons_errors, only: error_type
  use amontons_sparse, only: sparse_type, sparse_from_triplets
  implicit none
  private
  public :: constraints_type, constraint_row_type, ROW_ACCEPTED, ROW_REDUNDANT, ROW_CONFLICT
  public :: reset_constraints, prescribe_unknown, add_constraint_row, eliminate_constraints, scale_offsets, condense_forces, &
    build_condensation_matrix
  public :: find_multipliers, is_in_constraint_row, is_prescribed_along

  integer, parameter :: ROW_ACCEPTED = 0       !< the row made an unknown dependent
  integer, parameter :: ROW_REDUNDANT = 1      !< linearly dependent on rows of higher priority, without contradiction
  integer, parameter :: ROW_CONFLICT = 2       !< contradicts rows of higher priority: the row was dropped

  real(DP), parameter :: TOL_COEFFICIENT = 1.0e-10_DP   !< relative to the row's largest: taken as zero [-]
  real(DP), parameter :: MIN_FREE_SHARE = 1.0e-6_DP     !< of a free unknown in a displacement along a direction, over that in the
                                                        !! components: a smaller one is none [-]

  !> Combination of other rows in a row.
  type :: row_combination_type
    integer, allocatable :: row(:)
    real(DP), allocatable :: factor(:)
  end type row_combination_type

  !> One row sum coefficient * du(unknown) = rhs, or, once accepted, du(pivot) = sum coefficient * du(unknown) + rhs.
  type :: constraint_row_type
    integer, allocatable :: unknown(:)
    real(DP), allocatable :: coefficient(:)
    real(DP) :: rhs = 0
    integer :: pivot = 0
    integer :: tag = 0                         !< kind of the row, set by the caller
    ! Once accepted: the row as it was added, and its combination of other rows, for the multipliers.
    integer, allocatable :: original_unknown(:)
    real(DP), allocatable :: original_coefficient(:)
    real(DP) :: scale = 1                      !< row as added = scale * this one + sum amount * rows of higher priority
    type(row_combination_type) :: earlier_rows
    type(row_combination_type) :: later_rows  !< this one expanded = this one + sum amount * expanded rows of lower priority
  end type constraint_row_type

  !> The elimination. Unknowns are numbered 1 to n_unknowns; fixed and dependent ones are eliminated, the rest are free.
  type :: constraints_type
    integer :: n_unknowns = 0
    integer :: n_free = 0
    integer, allocatable :: owner(:)           !< (n_unknowns) 0 free, -1 fixed, k > 0 dependent by row k
    integer, allocatable :: free_of(:)         !< (n_unknowns) number among the free unknowns, 0 if not free
    real(DP), allocatable :: offset(:)         !< (n_unknowns) c
    type(sparse_type) :: transformation                   !< C (n_unknowns x n_free)
    type(constraint_row_type), allocatable :: rows(:)     !< accepted rows in the order of acceptance
    integer :: n_rows = 0
    real(DP), allocatable :: work(:)           !< (n_unknowns) sum of coefficients while a row is reduced; 0 between calls
    real(DP), allocatable :: rotation_length(:)  !< (n_unknowns / 3) or (0): coefficients over it choose the pivot [length], [-]
  end type constraints_type

contains

  !> All unknowns free, no rows.
  subroutine reset_constraints(self, n_unknowns, rotation_length)
    type(constraints_type), intent(inout) :: self   !< emptied; allocations of the same size are reused
    integer, intent(in) :: n_unknowns
    real(DP), intent(in), optional :: rotation_length(:)   !< (n_unknowns / 3) of rotations, 1 for displacements; or (0)
    if (self%n_unknowns /= n_unknowns) then
      if (allocated(self%owner)) deallocate (self%owner, self%free_of, self%offset, self%work)
      allocate (self%owner(n_unknowns), self%free_of(n_unknowns), self%offset(n_unknowns), self%work(n_unknowns))
    end if
    self%n_unknowns = n_unknowns
    self%owner = 0
    self%offset = 0.0_DP
    self%work = 0.0_DP
    self%n_rows = 0
    self%rotation_length = [real(DP) ::]
    if (present(rotation_length)) self%rotation_length = rotation_length
  end subroutine reset_constraints


  !> Prescribes one unknown: du = amount. The constraint of highest priority; call before any add_constraint_row.
  subroutine prescribe_unknown(self, unknown, amount)
    type(constraints_type), intent(inout) :: self
    integer, intent(in) :: unknown
    real(DP), intent(in) :: amount              !< [length]
    self%owner(unknown) = -1
    self%offset(unknown) = amount
  end subroutine prescribe_unknown


  !> Adds a row. The pivot is the unknown with the largest coefficient among the free candidates, else among all that remain.
  subroutine add_constraint_row(self, row, n_candidates, tolerance, row_status)
    type(constraints_type), intent(inout) :: self
    type(constraint_row_type), intent(in) :: row           !< sum coefficient * du(unknown) = rhs
    integer, intent(in) :: n_candidates         !< the first so many unknowns of the row are preferred as the pivot
    real(DP), intent(in) :: tolerance           !< a row without unknowns left and |rhs| above this is a conflict [length]
    integer, intent(out) :: row_status             !< ROW_...
    type(constraint_row_type) :: reduced
    integer :: k
    call eliminate_dependent(self, row, reduced, reduced%earlier_rows)
    if (size(reduced%unknown) == 0) then
      row_status = merge(ROW_CONFLICT, ROW_REDUNDANT, abs(reduced%rhs) > tolerance)
      return
    end if
    k = find_pivot(reduced%unknown, abs(reduced%coefficient) / lengths_of(self, reduced%unknown), row%unknown(:n_candidates))
    reduced%pivot = reduced%unknown(k)
    reduced%tag = row%tag
    reduced%original_unknown = row%unknown
    reduced%original_coefficient = row%coefficient
    reduced%scale = reduced%coefficient(k)
    reduced%rhs = reduced%rhs / reduced%coefficient(k)
    reduced%coefficient = -reduced%coefficient / reduced%coefficient(k)
    reduced%unknown = [reduced%unknown(:k - 1), reduced%unknown(k + 1:)]
    reduced%coefficient = [reduced%coefficient(:k - 1), reduced%coefficient(k + 1:)]
    call append_row(self, reduced)
    self%owner(reduced%pivot) = self%n_rows
    row_status = ROW_ACCEPTED
  end subroutine add_constraint_row


  !> The lengths of rotations among unknowns, 1 for displacements: without them the unit of length would choose the pivot.
  pure function lengths_of(self, unknown) result(length)
    type(constraints_type), intent(in) :: self
    integer, intent(in) :: unknown(:)
    real(DP) :: length(size(unknown))           !< [length] or [-]
    length = 1.0_DP
    if (size(self%rotation_length) > 0) length = self%rotation_length((unknown + 2) / 3)
  end function lengths_of


  !> Position of the pivot in the reduced row: largest coefficient among the candidates, else among all.
  pure integer function find_pivot(unknown, coefficient, candidates) result(position)
    integer, intent(in) :: unknown(:)           !< of the row
    real(DP), intent(in) :: coefficient(:)      !< absolute values, of one unit
    integer, intent(in) :: candidates(:)        !< unknowns
    real(DP) :: largest
    integer :: k
    position = 0
    largest = 1.0e-3_DP * maxval(coefficient)
    do k = 1, size(unknown)
      if (.not. any(candidates == unknown(k)) .or. coefficient(k) <= largest) cycle
      position = k
      largest = coefficient(k)
    end do
    if (position == 0) position = maxloc(coefficient, dim=1)
  end function find_pivot


  !> The row without fixed and dependent unknowns: they are substituted until only free ones remain.
  subroutine eliminate_dependent(self, row, reduced, combination)
    type(constraints_type), intent(inout) :: self
    type(constraint_row_type), intent(in) :: row
    type(constraint_row_type), intent(inout) :: reduced    !< unknown, coefficient and rhs are set
    type(row_combination_type), intent(out) :: combination         !< the substituted rows
    integer, allocatable :: list(:)             ! unknowns found; grows during the loop over it
    integer :: i, n
    real(DP) :: a, largest
    allocate (list(max(16, 4 * size(row%unknown))), combination%row(0), combination%factor(0))
    reduced%rhs = row%rhs
    largest = maxval(abs(row%coefficient))
    n = 0
    do i = 1, size(row%unknown)
      call add_coefficient(row%unknown(i), row%coefficient(i))
    end do
    i = 0
    do while (i < n)
      i = i + 1
      a = self%work(list(i))
      if (self%owner(list(i)) == 0 .or. a == 0.0_DP) cycle
      self%work(list(i)) = 0.0_DP
      call replace_unknown(list(i), a)
    end do
    call collect_remaining()

  contains

    !> Adds to the coefficient of an unknown and appends it to the list.
    subroutine add_coefficient(unknown, amount)
      integer, intent(in) :: unknown
      real(DP), intent(in) :: amount
      if (n == size(list)) list = [list, spread(0, 1, n)]
      n = n + 1
      list(n) = unknown
      self%work(unknown) = self%work(unknown) + amount
    end subroutine add_coefficient

    !> Replaces a fixed unknown by its value, a dependent one by its expression.
    subroutine replace_unknown(unknown, amount)
      integer, intent(in) :: unknown
      real(DP), intent(in) :: amount
      integer :: j, k
      k = self%owner(unknown)
      if (k < 0) then
        reduced%rhs = reduced%rhs - amount * self%offset(unknown)
        return
      end if
      reduced%rhs = reduced%rhs - amount * self%rows(k)%rhs
      combination%row = [combination%row, k]
      combination%factor = [combination%factor, amount]
      do j = 1, size(self%rows(k)%unknown)
        call add_coefficient(self%rows(k)%unknown(j), amount * self%rows(k)%coefficient(j))
      end do
    end subroutine replace_unknown

    !> The unknowns with a remaining coefficient; clears the work array.
    subroutine collect_remaining()
      integer :: j, m
      m = 0
      if (allocated(reduced%unknown)) deallocate (reduced%unknown, reduced%coefficient)
      allocate (reduced%unknown(n), reduced%coefficient(n))
      do j = 1, n
        if (abs(self%work(list(j))) > TOL_COEFFICIENT * largest) then
          m = m + 1
          reduced%unknown(m) = list(j)
          reduced%coefficient(m) = self%work(list(j))
        end if
        self%work(list(j)) = 0.0_DP
      end do
      reduced%unknown = reduced%unknown(:m)
      reduced%coefficient = reduced%coefficient(:m)
    end subroutine collect_remaining

  end subroutine eliminate_dependent


  !> Adds an accepted row; the list doubles when it is full.
  subroutine append_row(self, row)
    type(constraints_type), intent(inout) :: self
    type(constraint_row_type), intent(in) :: row
    type(constraint_row_type), allocatable :: larger(:)
    integer :: k
    if (.not. allocated(self%rows)) allocate (self%rows(64))
    if (self%n_rows == size(self%rows)) then
      allocate (larger(2 * self%n_rows))
      do k = 1, self%n_rows
        larger(k) = self%rows(k)
      end do
      call move_alloc(larger, self%rows)
    end if
    self%n_rows = self%n_rows + 1
    self%rows(self%n_rows) = row
  end subroutine append_row


  !> Scales all prescribed amounts, those of the rows included.
  pure subroutine scale_offsets(self, factor)
    type(constraints_type), intent(inout) :: self
    real(DP), intent(in) :: factor              !< [-]
    integer :: k
    self%offset = factor * self%offset
    do k = 1, self%n_rows
      self%rows(k)%rhs = factor * self%rows(k)%rhs
    end do
  end subroutine scale_offsets


  !> Numbers the free unknowns and builds C and c. Cost: linear in the entries of C.
  subroutine eliminate_constraints(self)
    type(constraints_type), intent(inout) :: self
    integer :: i
    self%n_free = 0
    do i = 1, self%n_unknowns
      self%free_of(i) = 0
      if (self%owner(i) /= 0) cycle
      self%n_free = self%n_free + 1
      self%free_of(i) = self%n_free
    end do
    do i = self%n_rows, 1, -1
      call expand_row(self, i)
    end do
    call fill_map(self)
  end subroutine eliminate_constraints


  !> Substitutes in row k the unknowns made dependent by later rows, which are expanded already.
  subroutine expand_row(self, k)
    type(constraints_type), intent(inout) :: self
    integer, intent(in) :: k
    type(constraint_row_type) :: whole, expanded
    integer :: j
    logical :: has_dependent
    has_dependent = .false.
    associate (row => self%rows(k))
      do j = 1, size(row%unknown)
        has_dependent = has_dependent .or. self%owner(row%unknown(j)) /= 0
      end do
      if (has_dependent) then
        whole%unknown = row%unknown
        whole%coefficient = row%coefficient
        whole%rhs = -row%rhs                    ! substitute() keeps sum a du = rhs, the row is du(pivot) = sum a du + rhs
        call eliminate_dependent(self, whole, expanded, row%later_rows)
        row%unknown = expanded%unknown
        row%coefficient = expanded%coefficient
        row%rhs = -expanded%rhs
      end if
      self%offset(row%pivot) = row%rhs
    end associate
  end subroutine expand_row


  !> C by rows: one entry for a free unknown, none for a fixed one, the expression for a dependent one.
  subroutine fill_map(self)
    type(constraints_type), intent(inout) :: self
    integer :: i, n
    associate (map => self%transformation)
      map%n_rows = self%n_unknowns
      map%n_columns = self%n_free
      if (allocated(map%first)) deallocate (map%first)
      if (allocated(map%column)) deallocate (map%column)
      if (allocated(map%value)) deallocate (map%value)
      allocate (map%first(self%n_unknowns + 1))
      map%first(1) = 1
      do i = 1, self%n_unknowns
        n = merge(1, 0, self%owner(i) == 0)
        if (self%owner(i) > 0) n = size(self%rows(self%owner(i))%unknown)
        map%first(i + 1) = map%first(i) + n
      end do
      n = map%first(self%n_unknowns + 1) - 1
      allocate (map%column(n), map%value(n))
      do i = 1, self%n_unknowns
        if (self%owner(i) == 0) then
          map%column(map%first(i)) = self%free_of(i)
          map%value(map%first(i)) = 1.0_DP
        else if (self%owner(i) > 0) then
          call fill_row(self%rows(self%owner(i)), map%first(i))
        end if
      end do
    end associate

  contains

    !> Writes one expression with ascending columns (insertion sort: rows are short).
    subroutine fill_row(row, start)
      type(constraint_row_type), intent(in) :: row
      integer, intent(in) :: start
      integer :: j, k, column
      do j = 1, size(row%unknown)
        column = self%free_of(row%unknown(j))
        k = start + j - 1
        do while (k > start)
          if (self%transformation%column(k - 1) < column) exit
          self%transformation%column(k) = self%transformation%column(k - 1)
          self%transformation%value(k) = self%transformation%value(k - 1)
          k = k - 1
        end do
        self%transformation%column(k) = column
        self%transformation%value(k) = row%coefficient(j)
      end do
    end subroutine fill_row

  end subroutine fill_map


  !> Whether rows contain an unknown that is free so far. Before: not finished.
  pure function is_in_constraint_row(self) result(is_in_row)
    type(constraints_type), intent(in) :: self
    logical :: is_in_row(self%n_unknowns)
    integer :: k
    is_in_row = .false.
    do k = 1, self%n_rows
      is_in_row(self%rows(k)%unknown) = .true.
      is_in_row(self%rows(k)%pivot) = .true.
    end do
  end function is_in_constraint_row


  !> Whether no free unknown moves a node along a direction: supports prescribe that displacement, by the node or by those that it
  !! depends on. Before: eliminated.
  pure logical function is_prescribed_along(self, node, direction) result(is_so)
    type(constraints_type), intent(in) :: self
    integer, intent(in) :: node                    !< from 1, with the unknowns 3 node - 2 to 3 node
    real(DP), intent(in) :: direction(3)           !< unit vector
    real(DP) :: along, largest
    integer :: i, j, k
    is_so = .true.
    associate (map => self%transformation)
      do k = map%first(3 * node - 2), map%first(3 * node + 1) - 1
        along = 0.0_DP
        largest = 0.0_DP
        do i = 1, 3
          do j = map%first(3 * (node - 1) + i), map%first(3 * (node - 1) + i + 1) - 1
            if (map%column(j) /= map%column(k)) cycle
            along = along + direction(i) * map%value(j)
            largest = max(largest, abs(map%value(j)))
          end do
        end do
        is_so = is_so .and. abs(along) <= MIN_FREE_SHARE * largest
      end do
    end associate
  end function is_prescribed_along


  !> The multipliers of the rows as they were added: sum multiplier * row balances the force on every dependent unknown.
  !!
  !! On the expanded rows a multiplier is minus the force on the row's pivot, which occurs in no other row. The two steps of the
  !! elimination are then reversed: the expansion from the first row on, the reduction from the last.
  subroutine find_multipliers(self, force, multiplier)
    type(constraints_type), intent(in) :: self      !< finished
    real(DP), intent(in) :: force(:, :)             !< (3, n_unknowns / 3) without the constraints [force]
    real(DP), allocatable, intent(out) :: multiplier(:)   !< (n_rows)
    integer :: k
    allocate (multiplier(self%n_rows))
    do k = 1, self%n_rows
      multiplier(k) = -force(mod(self%rows(k)%pivot - 1, 3) + 1, (self%rows(k)%pivot + 2) / 3)
    end do
    do k = 1, self%n_rows
      if (allocated(self%rows(k)%later_rows%row)) call add_to(self%rows(k)%later_rows, multiplier(k))
    end do
    do k = self%n_rows, 1, -1
      multiplier(k) = multiplier(k) / self%rows(k)%scale
      call add_to(self%rows(k)%earlier_rows, -multiplier(k))
    end do

  contains

    !> Adds to the multipliers of other rows.
    subroutine add_to(combination, factor)
      type(row_combination_type), intent(in) :: combination
      real(DP), intent(in) :: factor
      integer :: i
      do i = 1, size(combination%row)
        multiplier(combination%row(i)) = multiplier(combination%row(i)) + factor * combination%factor(i)
      end do
    end subroutine add_to

  end subroutine find_multipliers


  !> Forces on all unknowns condensed onto the free ones, C' f, written back in place; 0 at fixed and dependent unknowns.
  subroutine condense_forces(self, force, condensed)
    type(constraints_type), intent(in) :: self      !< finished
    real(DP), intent(in) :: force(:, :)             !< (3, n_unknowns / 3) [force]
    real(DP), intent(out) :: condensed(:, :)        !< (3, n_unknowns / 3) [force]
    integer :: i, j, k
    condensed = 0.0_DP
    do i = 1, self%n_unknowns
      if (self%owner(i) == 0) call add(i, force(mod(i - 1, 3) + 1, (i + 2) / 3))
    end do
    do k = 1, self%n_rows
      i = self%rows(k)%pivot
      do j = 1, size(self%rows(k)%unknown)
        call add(self%rows(k)%unknown(j), self%rows(k)%coefficient(j) * force(mod(i - 1, 3) + 1, (i + 2) / 3))
      end do
    end do

  contains

    !> Adds to the force on an unknown.
    subroutine add(unknown, amount)
      integer, intent(in) :: unknown
      real(DP), intent(in) :: amount
      associate (component => condensed(mod(unknown - 1, 3) + 1, (unknown + 2) / 3))
        component = component + amount
      end associate
    end subroutine add

  end subroutine condense_forces


  !> The same as a matrix E (n_unknowns x n_unknowns): condensed = E force.
  subroutine build_condensation_matrix(self, matrix, error)
    type(constraints_type), intent(in) :: self      !< finished
    type(sparse_type), intent(out) :: matrix
    type(error_type), allocatable, intent(out) :: error
    integer, allocatable :: row(:), column(:)
    real(DP), allocatable :: value(:)
    integer :: i, k, n, m
    n = count(self%owner == 0)
    m = n + sum([(size(self%rows(k)%unknown), k=1, self%n_rows)])
    allocate (row(m), column(m), value(m))
    row(:n) = pack([(i, i=1, self%n_unknowns)], self%owner == 0)
    column(:n) = row(:n)
    value(:n) = 1.0_DP
    do k = 1, self%n_rows
      m = n + size(self%rows(k)%unknown)
      row(n + 1:m) = self%rows(k)%unknown
      column(n + 1:m) = self%rows(k)%pivot
      value(n + 1:m) = self%rows(k)%coefficient
      n = m
    end do
    call sparse_from_triplets(self%n_unknowns, self%n_unknowns, row, column, value, matrix, error)
  end subroutine build_condensation_matrix

end module amontons_constraints
